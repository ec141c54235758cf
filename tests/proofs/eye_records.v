(* SPDX-License-Identifier: MIT *)
(* eye_records.clh: an edge function of a camera's record, times the record's scale, against EYE_EDGE_BOUND Q scale.

   Assumed: C, S and T (corner, step_x, step_y) have met one rounding; (X, Y) lies in the picture; no result is below
     2^-126
   unless it is 0 (underflow: prose, by the range of the level). The scale 1 / (EYE_EDGE_BOUND Q) is off by at most 7
     u of
   itself, a quotient by 2.5 ulp, a product, and Q is off as the lemma says: so a margin of 1 is enough where the
     error is
   below (1 - 7 u) EYE_EDGE_BOUND Q scale. Overflow: nothing exceeds 2^80. *)
From Coq Require Import Reals QArith Lra Psatz.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition a_z := 2%nat.
Definition b_x := 3%nat.
Definition b_y := 4%nat.
Definition b_z := 5%nat.
Definition eye_x := 6%nat.
Definition eye_y := 7%nat.
Definition eye_z := 8%nat.
Definition scale := 9%nat.
Definition X := 10%nat.
Definition Y := 11%nat.
Definition width := 12%nat.
Definition height := 13%nat.
Definition picture_0_0 := 14%nat.
Definition picture_0_1 := 15%nat.
Definition picture_0_2 := 16%nat.
Definition picture_1_0 := 17%nat.
Definition picture_1_1 := 18%nat.
Definition picture_1_2 := 19%nat.
Definition picture_2_0 := 20%nat.
Definition picture_2_1 := 21%nat.
Definition picture_2_2 := 22%nat.
Definition value :=
  Fma (Given X 0) (Mul (Add (Add (Mul (Given picture_1_0 1) (Sub (Mul (Diff a_y eye_y) (Diff b_z a_z)) (Mul (Diff
    a_z eye_z) (Diff b_y a_y)))) (Mul (Given picture_1_1 1) (Sub (Mul (Diff a_z eye_z) (Diff b_x a_x)) (Mul (Diff
    a_x eye_x) (Diff b_z a_z))))) (Mul (Given picture_1_2 1) (Sub (Mul (Diff a_x eye_x) (Diff b_y a_y)) (Mul (Diff
    a_y eye_y) (Diff b_x a_x))))) (Given scale 0)) (Fma (Given Y 0) (Mul (Add (Add (Mul (Given picture_2_0 1) (Sub
    (Mul (Diff a_y eye_y) (Diff b_z a_z)) (Mul (Diff a_z eye_z) (Diff b_y a_y)))) (Mul (Given picture_2_1 1) (Sub
    (Mul (Diff a_z eye_z) (Diff b_x a_x)) (Mul (Diff a_x eye_x) (Diff b_z a_z))))) (Mul (Given picture_2_2 1) (Sub
    (Mul (Diff a_x eye_x) (Diff b_y a_y)) (Mul (Diff a_y eye_y) (Diff b_x a_x))))) (Given scale 0)) (Mul (Add (Add
    (Mul (Given picture_0_0 1) (Sub (Mul (Diff a_y eye_y) (Diff b_z a_z)) (Mul (Diff a_z eye_z) (Diff b_y a_y))))
    (Mul (Given picture_0_1 1) (Sub (Mul (Diff a_z eye_z) (Diff b_x a_x)) (Mul (Diff a_x eye_x) (Diff b_z a_z)))))
    (Mul (Given picture_0_2 1) (Sub (Mul (Diff a_x eye_x) (Diff b_y a_y)) (Mul (Diff a_y eye_y) (Diff b_x a_x)))))
    (Given scale 0))).
Definition size :=
  Add (Add (Mul (Add (Abs (Mul (Diff a_x eye_x) (Diff b_z a_z))) (Abs (Mul (Diff a_z eye_z) (Diff b_x a_x)))) (Add
    (Add (Abs (Given picture_0_1 1)) (Mul (Abs (Given picture_1_1 1)) (Given width 0))) (Mul (Abs (Given picture_2_1
    1)) (Given height 0)))) (Mul (Add (Abs (Mul (Diff a_y eye_y) (Diff b_z a_z))) (Abs (Mul (Diff a_z eye_z) (Diff
    b_y a_y)))) (Add (Add (Abs (Given picture_0_0 1)) (Mul (Abs (Given picture_1_0 1)) (Given width 0))) (Mul (Abs
    (Given picture_2_0 1)) (Given height 0))))) (Mul (Add (Abs (Mul (Diff a_x eye_x) (Diff b_y a_y))) (Abs (Mul
    (Diff a_y eye_y) (Diff b_x a_x)))) (Add (Add (Abs (Given picture_0_2 1)) (Mul (Abs (Given picture_1_2 1)) (Given
    width 0))) (Mul (Abs (Given picture_2_2 1)) (Given height 0)))).
(* bound = bound_constant * size *)
Definition bound_constant : Q := 3298535 # 4398046511104.
(* end: from the kernels *)

Section Edge.
Variable x : nat -> R.
Open Scope R_scope.
Hypotheses (X_in_picture : Rabs (x X) <= x width) (Y_in_picture : Rabs (x Y) <= x height).

Definition scaled_size := Mul size (Abs (Given scale 0)).
Definition constant : Q := bound_constant * (1 - (7 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (rate u32Q value scaled_size / (1 - (7 # 2 ^ 24)))%Q.

Lemma products : permanent x value <= permanent x scaled_size.
Proof.
  assert (X0 := Rabs_pos (x X)). assert (Y0 := Rabs_pos (x Y)).
  assert (W := Rabs_pos_eq (x width) ltac:(lra)). assert (H := Rabs_pos_eq (x height) ltac:(lra)).
  cbv [value scaled_size size permanent]. rewrite W, H.
  set (m1 := Rabs (x a_y - x eye_y) * Rabs (x b_z - x a_z)). set (m2 := Rabs (x a_z - x eye_z) * Rabs (x b_y - x a_y)).
  set (m3 := Rabs (x a_z - x eye_z) * Rabs (x b_x - x a_x)). set (m4 := Rabs (x a_x - x eye_x) * Rabs (x b_z - x a_z)).
  set (m5 := Rabs (x a_x - x eye_x) * Rabs (x b_y - x a_y)). set (m6 := Rabs (x a_y - x eye_y) * Rabs (x b_x - x a_x)).
  assert (P : forall i j k l, 0 <= Rabs (x i - x j) * Rabs (x k - x l)) by (intros; apply Rmult_le_pos; apply Rabs_pos).
  assert (0 <= m1) by apply P. assert (0 <= m2) by apply P. assert (0 <= m3) by apply P. assert (0 <= m4) by apply P.
  assert (0 <= m5) by apply P. assert (0 <= m6) by apply P.
  assert (grows : forall a b c y w, Rabs y <= w -> 0 <= a -> 0 <= b -> 0 <= c ->
    Rabs y * ((a * (m1 + m2) + b * (m3 + m4) + c * (m5 + m6)) * Rabs (x scale)) <=
    w * ((a * (m1 + m2) + b * (m3 + m4) + c * (m5 + m6)) * Rabs (x scale))).
  { intros. apply Rmult_le_compat_r; auto. apply Rmult_le_pos; [| apply Rabs_pos].
    assert (0 <= a * (m1 + m2)) by (apply Rmult_le_pos; lra). assert (0 <= b * (m3 + m4)) by (apply Rmult_le_pos; lra).
    assert (0 <= c * (m5 + m6)) by (apply Rmult_le_pos; lra). lra. }
  assert (G1 := grows _ _ _ _ _ X_in_picture (Rabs_pos (x picture_1_0)) (Rabs_pos (x picture_1_1))
    (Rabs_pos (x picture_1_2))).
  assert (G2 := grows _ _ _ _ _ Y_in_picture (Rabs_pos (x picture_2_0)) (Rabs_pos (x picture_2_1))
    (Rabs_pos (x picture_2_2))). lra.
Qed.

Theorem error v s :
  within_limits x (Q2R any) (Q2R any) value -> within_limits x (Q2R any) (Q2R any) scaled_size ->
  computes_normal x value v -> computes_normal x scaled_size s -> 0 <= s ->
  Rabs (v - real x value) <= Q2R constant * s.
Proof.
  assert (X0 := Rabs_pos (x X)). assert (Y0 := Rabs_pos (x Y)).
  assert (W := Rabs_pos_eq (x width) ltac:(lra)). assert (H := Rabs_pos_eq (x height) ltac:(lra)).
  intros. eapply float_error_of_normal_numbers with (size := scaled_size) (m := fun _ => any) (d := fun _ _ => any);
    try eassumption.
  - vm_compute. reflexivity.
  - apply products.
  - cbv [scaled_size size real permanent]. rewrite !Rabs_mult, !W, !H. ring.
Qed.
End Edge.
Definition constants := Eval vm_compute in shown least_bound bound_constant.
Print constants.
Print Assumptions error.
