(* SPDX-License-Identifier: MIT *)
(* strip_triangle.clh: twice the area of two corners and the point, in a strip's coordinates (beside()), against 2^-19 times
   the product of their distances |x| + |y|.

   Assumed: a sector's vectors are unit vectors times `halves`, off by two roundings; no result is below 2^-126 unless it is
   0. The bound rounds once more than `size` (3 u below have room). Overflow: coordinates are below 2^20 half cells. *)
From Coq Require Import Reals QArith Lra Psatz.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition b_x := 2%nat.
Definition b_y := 3%nat.
Definition at_x := 4%nat.
Definition at_y := 5%nat.
Definition halves := 6%nat.
Definition sector_0_0 := 7%nat.
Definition sector_0_1 := 8%nat.
Definition sector_1_0 := 9%nat.
Definition sector_1_1 := 10%nat.
Definition value :=
  Fma (Fma (Given sector_0_0 2) (Diff a_x at_x) (Mul (Given sector_0_1 2) (Diff a_y at_y))) (Fma (Given sector_1_0
    2) (Diff b_x at_x) (Mul (Given sector_1_1 2) (Diff b_y at_y))) (Mul (Fma (Given sector_0_0 2) (Diff b_x at_x)
    (Mul (Given sector_0_1 2) (Diff b_y at_y))) (Neg (Fma (Given sector_1_0 2) (Diff a_x at_x) (Mul (Given
    sector_1_1 2) (Diff a_y at_y))))).
Definition size :=
  Mul (Mul (Add (Abs (Diff a_x at_x)) (Abs (Diff a_y at_y))) (Given halves 0)) (Mul (Add (Abs (Diff b_x at_x)) (Abs
    (Diff b_y at_y))) (Given halves 0)).
Definition bound :=
  Mul (Mul (Add (Abs (Diff b_x at_x)) (Abs (Diff b_y at_y))) (Given halves 0)) (Times (1 # 524288) (Mul (Add (Abs
    (Diff a_x at_x)) (Abs (Diff a_y at_y))) (Given halves 0))).
(* end: from the kernels *)

Section Area.
Variable x : nat -> R.
Open Scope R_scope.
Hypotheses (along_x : Rabs (x sector_0_0) <= x halves) (along_y : Rabs (x sector_0_1) <= x halves).
Hypotheses (across_x : Rabs (x sector_1_0) <= x halves) (across_y : Rabs (x sector_1_1) <= x halves).

Definition kernels_constant : Q := 1 # 524288.
Lemma bound_is : bound = Mul (Mul (Add (Abs (Diff b_x at_x)) (Abs (Diff b_y at_y))) (Given halves 0))
  (Times kernels_constant (Mul (Add (Abs (Diff a_x at_x)) (Abs (Diff a_y at_y))) (Given halves 0))).
Proof. reflexivity. Qed.

Definition twice := Times 2 size.
Definition constant : Q := kernels_constant * (1 # 2) * (1 - (3 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (2 * rate u32Q value twice / (1 - (3 # 2 ^ 24)))%Q.

Lemma products : permanent x value <= permanent x twice.
Proof.
  assert (h0 := Rabs_pos (x sector_0_0)). assert (H := Rabs_pos_eq (x halves) ltac:(lra)).
  assert (two : Rabs (Q2R 2) = 2) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  cbv [value twice size permanent]. rewrite H, two.
  set (h := x halves) in *. set (p := Rabs (x a_x - x at_x)). set (q := Rabs (x a_y - x at_y)).
  set (r := Rabs (x b_x - x at_x)). set (s := Rabs (x b_y - x at_y)).
  assert (0 <= p /\ 0 <= q /\ 0 <= r /\ 0 <= s) by (repeat split; apply Rabs_pos).
  assert (one : forall i y, Rabs (x i) <= h -> 0 <= y -> 0 <= Rabs (x i) * y <= h * y).
  { intros i y Hi Hy. assert (I := Rabs_pos (x i)). split; [now apply Rmult_le_pos | now apply Rmult_le_compat_r]. }
  assert (A1 := one _ p along_x ltac:(lra)). assert (A2 := one _ q along_y ltac:(lra)).
  assert (A3 := one _ r across_x ltac:(lra)). assert (A4 := one _ s across_y ltac:(lra)).
  assert (A5 := one _ r along_x ltac:(lra)). assert (A6 := one _ s along_y ltac:(lra)).
  assert (A7 := one _ p across_x ltac:(lra)). assert (A8 := one _ q across_y ltac:(lra)).
  assert (G1 : (Rabs (x sector_0_0) * p + Rabs (x sector_0_1) * q) * (Rabs (x sector_1_0) * r + Rabs (x sector_1_1) * s) <=
    (h * p + h * q) * (h * r + h * s)) by (apply Rmult_le_compat; lra).
  assert (G2 : (Rabs (x sector_0_0) * r + Rabs (x sector_0_1) * s) * (Rabs (x sector_1_0) * p + Rabs (x sector_1_1) * q) <=
    (h * r + h * s) * (h * p + h * q)) by (apply Rmult_le_compat; lra).
  lra.
Qed.

Theorem error v s :
  within_limits x (Q2R any) (Q2R any) value -> within_limits x (Q2R any) (Q2R any) twice ->
  computes_normal x value v -> computes_normal x twice s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s.
Proof.
  assert (h0 := Rabs_pos (x sector_0_0)). assert (H := Rabs_pos_eq (x halves) ltac:(lra)).
  assert (two : Rabs (Q2R 2) = Q2R 2) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  intros. eapply float_error_of_normal_numbers with (size := twice) (m := any) (d := any); try eassumption.
  - vm_compute. reflexivity.
  - apply products.
  - cbv [twice size real permanent]. rewrite H, two. reflexivity.
Qed.
End Area.
Definition constants := Eval vm_compute in shown least_bound kernels_constant.
Print constants.
Print Assumptions error.
