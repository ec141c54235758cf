(* SPDX-License-Identifier: MIT *)
(* det3.clh, the double level: det(u1 - u0, v1 - v0, w1 - w0).

   Assumed: the inputs are finite floats. So they are multiples of 2^-149 below 2^128, differences, products of two
     and of
   three are multiples of 2^-149, 2^-298 and 2^-447, rounded or not, and all is below 2^391: no result is a denormal,
     and
   nothing overflows (rounds64 assumes the first, Roundings.v the second). *)
From Coq Require Import Reals QArith.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition u1_x := 0%nat.
Definition u1_y := 1%nat.
Definition u1_z := 2%nat.
Definition u0_x := 3%nat.
Definition u0_y := 4%nat.
Definition u0_z := 5%nat.
Definition v1_x := 6%nat.
Definition v1_y := 7%nat.
Definition v1_z := 8%nat.
Definition v0_x := 9%nat.
Definition v0_y := 10%nat.
Definition v0_z := 11%nat.
Definition w1_x := 12%nat.
Definition w1_y := 13%nat.
Definition w1_z := 14%nat.
Definition w0_x := 15%nat.
Definition w0_y := 16%nat.
Definition w0_z := 17%nat.
Definition value :=
  Add (Add (Mul (Diff w1_x w0_x) (Sub (Mul (Diff u1_y u0_y) (Diff v1_z v0_z)) (Mul (Diff u1_z u0_z) (Diff v1_y
    v0_y)))) (Mul (Diff w1_y w0_y) (Sub (Mul (Diff u1_z u0_z) (Diff v1_x v0_x)) (Mul (Diff u1_x u0_x) (Diff v1_z
    v0_z))))) (Mul (Diff w1_z w0_z) (Sub (Mul (Diff u1_x u0_x) (Diff v1_y v0_y)) (Mul (Diff u1_y u0_y) (Diff v1_x
    v0_x)))).
Definition size :=
  Add (Add (Mul (Abs (Diff w1_x w0_x)) (Add (Mul (Abs (Diff u1_y u0_y)) (Abs (Diff v1_z v0_z))) (Mul (Abs (Diff u1_z
    u0_z)) (Abs (Diff v1_y v0_y))))) (Mul (Abs (Diff w1_y w0_y)) (Add (Mul (Abs (Diff u1_x u0_x)) (Abs (Diff v1_z
    v0_z))) (Mul (Abs (Diff u1_z u0_z)) (Abs (Diff v1_x v0_x)))))) (Mul (Abs (Diff w1_z w0_z)) (Add (Mul (Abs (Diff
    u1_x u0_x)) (Abs (Diff v1_y v0_y))) (Mul (Abs (Diff u1_y u0_y)) (Abs (Diff v1_x v0_x))))).
(* bound = bound_constant * size *)
Definition bound_constant : Q := 2535301200456459 # 2535301200456458802993406410752.
(* end: from the kernels *)

Section Det3.
Variable x : nat -> R.
Variables m d : Q.
Open Scope R_scope.

Definition least_bound := Eval vm_compute in least_constant u64Q 0 (all 0) (all 0) (apart 0) value size 0.
Lemma less_is_not : is_enough u64Q 0 (all 0) (all 0) (apart 0) value size 0 (least_bound * (1 - (1 # 2 ^ 60))) = false.
Proof. vm_compute. reflexivity. Qed.

Let difference i j := x i - x j.
Let ux := difference u1_x u0_x. Let uy := difference u1_y u0_y. Let uz := difference u1_z u0_z.
Let vx := difference v1_x v0_x. Let vy := difference v1_y v0_y. Let vz := difference v1_z v0_z.
Let wx := difference w1_x w0_x. Let wy := difference w1_y w0_y. Let wz := difference w1_z w0_z.
Lemma value_is_the_determinant :
  real x value = wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx).
Proof. cbv [value real]. unfold ux, uy, uz, vx, vy, vz, wx, wy, wz, difference. ring. Qed.

Theorem sign v s b :
  within_limits x (Q2R (2 ^ 129)) (Q2R (2 ^ 129)) value -> within_limits x (Q2R (2 ^ 129)) (Q2R (2 ^ 129)) size ->
  computes64 x value v -> computes64 x size s -> 0 <= s -> rounds64 (Q2R bound_constant * s) b ->
  b < Rabs v -> (0 < v <-> 0 < real x value) /\ real x value <> 0.
Proof.
  intros. eapply double_filter with (constant := bound_constant) (m := all (2 ^ 129)) (d := apart (2 ^ 129)); try
    eassumption.
  - vm_compute. reflexivity.
  - cbv [value size real permanent]; same_products.
  - cbv [value size real permanent]; same_products.
Qed.
End Det3.
Definition constants := Eval vm_compute in shown (least_bound) (bound_constant).
Print constants.
Print Assumptions sign.
