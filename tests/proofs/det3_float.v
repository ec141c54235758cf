(* SPDX-License-Identifier: MIT *)
(* det3.clh, the float level: det(u1 - u0, v1 - v0, w1 - w0).

   Assumed: the inputs are finite floats, and no difference exceeds 2^21. (No computed difference exceeds 2^20; a real
     one
   is at most 1 + 2^-23 times as large.) Overflow: nothing exceeds 2^66. *)
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
  Add (Add (Mul (Abs (Diff w1_x w0_x)) (Add (Abs (Mul (Diff u1_y u0_y) (Diff v1_z v0_z))) (Abs (Mul (Diff u1_z u0_z)
    (Diff v1_y v0_y))))) (Mul (Abs (Diff w1_y w0_y)) (Add (Abs (Mul (Diff u1_x u0_x) (Diff v1_z v0_z))) (Abs (Mul
    (Diff u1_z u0_z) (Diff v1_x v0_x)))))) (Mul (Abs (Diff w1_z w0_z)) (Add (Abs (Mul (Diff u1_x u0_x) (Diff v1_y
    v0_y))) (Abs (Mul (Diff u1_y u0_y) (Diff v1_x v0_x))))).
(* bound: where max(abs(sub(w1_x, w0_x)), max(abs(sub(u1_x, u0_x)), abs(sub(v1_x, v0_x)))) <= 1048576.0 *)
(* bound: where max(abs(sub(w1_y, w0_y)), max(abs(sub(u1_y, u0_y)), abs(sub(v1_y, v0_y)))) <= 1048576.0 *)
(* bound: where max(abs(sub(w1_z, w0_z)), max(abs(sub(u1_z, u0_z)), abs(sub(v1_z, v0_z)))) <= 1048576.0 *)
(* bound: where size >= 9.094947017729282e-13 *)
(* bound = bound_constant * size *)
Definition bound_constant : Q := 8796093 # 17592186044416.
Definition lanes_value :=
  value.
(* lanes_bound: where max(abs(sub(u1_z, u0_z)), max(abs(sub(u1_x, u0_x)), abs(sub(u1_y, u0_y)))) <= 1048576.0 *)
(* lanes_bound: where max(abs(sub(v1_z, v0_z)), max(abs(sub(v1_x, v0_x)), abs(sub(v1_y, v0_y)))) <= 1048576.0 *)
(* lanes_bound: where max(abs(sub(w1_z, w0_z)), max(abs(sub(w1_x, w0_x)), abs(sub(w1_y, w0_y)))) <= 1048576.0 *)
(* lanes_bound: where size >= 9.094947017729282e-13 *)
(* lanes_bound = lanes_bound_constant * size *)
Definition lanes_bound_constant : Q := 8796093 # 17592186044416.
(* end: from the kernels *)

Section Det3.
Variable x : nat -> R.
Open Scope R_scope.

Let difference i j := x i - x j.
Let ux := difference u1_x u0_x. Let uy := difference u1_y u0_y. Let uz := difference u1_z u0_z.
Let vx := difference v1_x v0_x. Let vy := difference v1_y v0_y. Let vz := difference v1_z v0_z.
Let wx := difference w1_x w0_x. Let wy := difference w1_y w0_y. Let wz := difference w1_z w0_z.
Lemma value_is_the_determinant :
  real x value = wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx).
Proof. cbv [value real]. unfold ux, uy, uz, vx, vy, vz, wx, wy, wz, difference. ring. Qed.

Definition least : Q := 1 # 2 ^ 40.
Definition least_bound := Eval vm_compute in least_constant u32Q h32Q (all h32Q) (all 0) (apart (2 ^ 21)) value size
  least.
Lemma bound_is_enough : is_enough u32Q h32Q (all h32Q) (all 0) (apart (2 ^ 21)) value size least bound_constant = true.
Proof. vm_compute. reflexivity. Qed.
Lemma less_is_not : is_enough u32Q h32Q (all h32Q) (all 0) (apart (2 ^ 21)) value size least (least_bound * (1 - (1 #
  2 ^ 30))) = false.
Proof. vm_compute. reflexivity. Qed.

Theorem sign v s t b :
  within_limits x (Q2R 0) (Q2R (2 ^ 21)) value -> within_limits x (Q2R 0) (Q2R (2 ^ 21)) size ->
  computes32 x value v -> computes32 x size s -> Q2R least <= s -> seen32 s t -> rounds32 (Q2R bound_constant * t) b ->
  b < Rabs v -> (0 < v <-> 0 < real x value) /\ real x value <> 0.
Proof.
  intros. eapply (float_filter x (all h32Q)); try exact (all_may_lose x); try eassumption; try exact bound_is_enough;
    cbv [value size real permanent]; same_products.
Qed.
(* The same filter in lanes (det3_lanes.clh). *)
Lemma lanes_are_the_same : lanes_value = value /\ lanes_bound_constant = bound_constant.
Proof. split; reflexivity. Qed.
End Det3.
Definition constants := Eval vm_compute in shown (least_bound) (bound_constant).
Print constants.
Print Assumptions sign.
