(* SPDX-License-Identifier: MIT *)
(* beam_intersect.clh: an edge's value for a light, e = det(A - P, B - A, D), against BEAM_BOUND |A - P|_1 |B - A|_1.

   Assumed: D has met one rounding (its scaling, or S - P), no coordinate of it exceeds 1, and no difference 2^21. The
   kernel multiplies the bound's factors with at most 5 roundings (BEAM_BOUND, the largest edge, reach, the sum): the
     last
   lemma. Overflow: nothing exceeds 2^50. Point lights: light_boxes.v. *)
From Coq Require Import Reals QArith Lra Psatz.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition A_x := 0%nat.
Definition A_y := 1%nat.
Definition A_z := 2%nat.
Definition B_x := 3%nat.
Definition B_y := 4%nat.
Definition B_z := 5%nat.
Definition P_x := 6%nat.
Definition P_y := 7%nat.
Definition P_z := 8%nat.
Definition D_x := 9%nat.
Definition D_y := 10%nat.
Definition D_z := 11%nat.
Definition value :=
  Fma (Fma (Diff A_y P_y) (Diff B_z A_z) (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Given D_x 1) (Fma (Fma (Diff
    A_z P_z) (Diff B_x A_x) (Mul (Neg (Diff A_x P_x)) (Diff B_z A_z))) (Given D_y 1) (Mul (Fma (Diff A_x P_x) (Diff
    B_y A_y) (Mul (Neg (Diff A_y P_y)) (Diff B_x A_x))) (Given D_z 1))).
Definition size :=
  Mul (Add (Abs (Diff A_z P_z)) (Add (Abs (Diff A_x P_x)) (Abs (Diff A_y P_y)))) (Add (Abs (Diff B_z A_z)) (Add (Abs
    (Diff B_x A_x)) (Abs (Diff B_y A_y)))).
(* bound = bound_constant * size *)
Definition bound_constant : Q := 9147937 # 17592186044416.
(* end: from the kernels *)

Section Beam.
Variable x : nat -> R.
Open Scope R_scope.
Hypotheses (small_x : Rabs (x D_x) <= 1) (small_y : Rabs (x D_y) <= 1) (small_z : Rabs (x D_z) <= 1).

Definition constant : Q := bound_constant * (1 - (5 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (rate u32Q value size / (1 - (5 # 2 ^ 24)))%Q.

Theorem error v s :
  within_limits x (Q2R 1) (Q2R (2 ^ 21)) value -> within_limits x (Q2R 1) (Q2R (2 ^ 21)) size ->
  computes32 x value v -> computes32 x size s -> 0 <= s ->
  Rabs (v - real x value) <= Q2R constant * s + Q2R (1 # 2 ^ 64).
Proof.
  intros. eapply float_error with (size := size) (f := all h32Q) (m := all 1) (d := apart (2 ^ 21)); try eassumption;
    try exact (all_may_lose x).
  - vm_compute. reflexivity.
  - cbv [value size permanent].
    set (a := Rabs (x A_x - x P_x)). set (b := Rabs (x A_y - x P_y)). set (c := Rabs (x A_z - x P_z)).
    set (d := Rabs (x B_x - x A_x)). set (e := Rabs (x B_y - x A_y)). set (f := Rabs (x B_z - x A_z)).
    assert (0 <= a /\ 0 <= b /\ 0 <= c /\ 0 <= d /\ 0 <= e /\ 0 <= f) by (repeat split; apply Rabs_pos).
    assert (times : forall p q y, 0 <= p -> 0 <= q -> Rabs y <= 1 -> p * q * Rabs y <= p * q).
    { intros p q y Hp Hq Hy. assert (Hpq := Rmult_le_pos _ _ Hp Hq).
      assert (G := Rmult_le_compat_l _ _ _ Hpq Hy). lra. }
    assert (times_2 : forall p q s t y, 0 <= p -> 0 <= q -> 0 <= s -> 0 <= t -> Rabs y <= 1 ->
      (p * q + s * t) * Rabs y <= p * q + s * t).
    { intros p q s' t y Hp Hq Hs Ht Hy. assert (G1 := times p q y Hp Hq Hy). assert (G2 := times s' t y Hs Ht Hy).
      lra. }
    assert (G1 := times_2 b f c e (x D_x) ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra) small_x).
    assert (G2 := times_2 c d a f (x D_y) ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra) small_y).
    assert (G3 := times_2 a e b d (x D_z) ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra) small_z).
    assert (0 <= a * d) by (apply Rmult_le_pos; lra). assert (0 <= b * e) by (apply Rmult_le_pos; lra).
    assert (0 <= c * f) by (apply Rmult_le_pos; lra). lra.
  - cbv [size real permanent]. reflexivity.
Qed.
End Beam.
Definition constants := Eval vm_compute in shown (least_bound) (bound_constant).
Print constants.
Print Assumptions error.
