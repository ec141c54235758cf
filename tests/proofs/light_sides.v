(* SPDX-License-Identifier: MIT *)
(* light_sides.cl: the least value of n . D over the directional lights of a cone, n a receiver's normal as it is
   computed, against 32 u (the sum of the sizes in n).

   Assumed: no coordinate of the cone's vectors exceeds 1; they are 0 or no denormals (the host widens a cone by
   more than that: docs/numerics.md, 16). Denormals may be kept or flushed otherwise. The bound rounds twice more
   than `size`. Overflow: differences are at most 2^20, or the bound is infinite. *)
From Coq Require Import Reals QArith Lra Psatz.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition a_z := 2%nat.
Definition b_x := 3%nat.
Definition b_y := 4%nat.
Definition b_z := 5%nat.
Definition c_x := 6%nat.
Definition c_y := 7%nat.
Definition c_z := 8%nat.
Definition cone_2_0 := 9%nat.
Definition cone_2_1 := 10%nat.
Definition cone_2_2 := 11%nat.
Definition cone_3_0 := 12%nat.
Definition cone_3_1 := 13%nat.
Definition cone_3_2 := 14%nat.
Definition cone_1_0 := 15%nat.
Definition cone_1_1 := 16%nat.
Definition cone_1_2 := 17%nat.
Definition value :=
  Sub (Fma (Given cone_1_0 0) (Sub (Mul (Diff b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z) (Diff c_y a_y))) (Fma
    (Given cone_1_1 0) (Sub (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff b_x a_x) (Diff c_z a_z))) (Mul (Given
    cone_1_2 0) (Sub (Mul (Diff b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x)))))) (Add (Abs (Fma
    (Given cone_2_0 0) (Sub (Mul (Diff b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z) (Diff c_y a_y))) (Fma (Given
    cone_2_1 0) (Sub (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff b_x a_x) (Diff c_z a_z))) (Mul (Given cone_2_2
    0) (Sub (Mul (Diff b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x))))))) (Abs (Fma (Given cone_3_0
    0) (Sub (Mul (Diff b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z) (Diff c_y a_y))) (Fma (Given cone_3_1 0) (Sub
    (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff b_x a_x) (Diff c_z a_z))) (Mul (Given cone_3_2 0) (Sub (Mul (Diff
    b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x)))))))).
Definition size :=
  Add (Abs (Add (Abs (Mul (Diff b_x a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x))))) (Add (Abs (Add
    (Abs (Mul (Diff b_x a_x) (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_x a_x))))) (Abs (Add (Abs (Mul (Diff
    b_y a_y) (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_y a_y)))))).
(* bound = bound_constant * size *)
Definition bound_constant : Q := 1 # 524288.
Definition bound_rest : Q := 1 # 316912650057057350374175801344.
(* end: from the kernels *)

Section Cone.
Variable x : nat -> R.
Open Scope R_scope.
Let below_one i := Rabs (x i) <= 1.
Hypotheses (middle_x : below_one cone_1_0) (middle_y : below_one cone_1_1) (middle_z : below_one cone_1_2).
Hypotheses (across_x : below_one cone_2_0) (across_y : below_one cone_2_1) (across_z : below_one cone_2_2).
Hypotheses (along_x : below_one cone_3_0) (along_y : below_one cone_3_1) (along_z : below_one cone_3_2).

(* The cone's coordinates are 0 or no denormals; the corners may be. *)
Definition may_lose (i : nat) : Q := if Nat.leb cone_2_0 i then 0 else h32Q.
Hypothesis cone_is_normal : forall i, (cone_2_0 <= i)%nat -> x i = 0 \/ 2 * h32 <= Rabs (x i).
Lemma cone_keeps : keeps x may_lose.
Proof.
  intros i. unfold may_lose. destruct (Nat.leb_spec cone_2_0 i); [right | now left]. split; [reflexivity |]. now apply
    cone_is_normal.
Qed.

(* Middle, across and along. *)
Definition thrice := Times 3 size.
Definition constant : Q := bound_constant * (1 # 3) * (1 - (4 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (3 * rate u32Q value thrice / (1 - (4 # 2 ^ 24)))%Q.

Lemma products : permanent x value <= permanent x thrice.
Proof.
  assert (three : Rabs (Q2R 3) = 3) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  cbv [value thrice size permanent]. rewrite three.
  set (p := Rabs (x b_x - x a_x)). set (q := Rabs (x b_y - x a_y)). set (r := Rabs (x b_z - x a_z)).
  set (s := Rabs (x c_x - x a_x)). set (t := Rabs (x c_y - x a_y)). set (u := Rabs (x c_z - x a_z)).
  assert (P : forall i j k l, 0 <= Rabs (x i - x j) * Rabs (x k - x l)) by (intros; apply Rmult_le_pos; apply Rabs_pos).
  assert (0 <= q * u + r * t) by (apply Rplus_le_le_0_compat; apply P).
  assert (0 <= r * s + p * u) by (apply Rplus_le_le_0_compat; apply P).
  assert (0 <= p * t + q * s) by (apply Rplus_le_le_0_compat; apply P).
  assert (one : forall i y, below_one i -> 0 <= y -> Rabs (x i) * y <= y).
  { intros i y Hi Hy. assert (G := Rmult_le_compat_r _ _ _ Hy Hi). lra. }
  assert (A1 := one _ (q * u + r * t) middle_x ltac:(lra)). assert (A2 := one _ (r * s + p * u) middle_y ltac:(lra)).
  assert (A3 := one _ (p * t + q * s) middle_z ltac:(lra)).
  assert (B1 := one _ (q * u + r * t) across_x ltac:(lra)). assert (B2 := one _ (r * s + p * u) across_y ltac:(lra)).
  assert (B3 := one _ (p * t + q * s) across_z ltac:(lra)).
  assert (C1 := one _ (q * u + r * t) along_x ltac:(lra)). assert (C2 := one _ (r * s + p * u) along_y ltac:(lra)).
  assert (C3 := one _ (p * t + q * s) along_z ltac:(lra)). lra.
Qed.

Theorem error v s :
  within_limits x (Q2R 1) (Q2R (2 ^ 20)) value -> within_limits x (Q2R 1) (Q2R (2 ^ 20)) thrice ->
  computes32 x value v -> computes32 x thrice s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s + Q2R
    bound_rest.
Proof.
  assert (three : Rabs (Q2R 3) = Q2R 3) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  intros. eapply float_error with (size := thrice) (f := may_lose) (m := all 1) (d := apart (2 ^ 20)); try eassumption;
    try exact cone_keeps.
  - vm_compute. reflexivity.
  - apply products.
  - cbv [thrice size real permanent]. rewrite three.
    repeat (rewrite Rabs_mult || rewrite Rabs_Rabsolu || rewrite (Rabs_pos_eq (Rabs _ * Rabs _ + _))
      by (apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos)). reflexivity.
Qed.
End Cone.
Definition constants := Eval vm_compute in shown least_bound bound_constant.
Print constants.
Definition rests := Eval vm_compute in shown (least_rest u32Q h32Q may_lose (all 1) (apart (2 ^ 20)) value thrice)
  bound_rest.
Print rests.
Print Assumptions error.
