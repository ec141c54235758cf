(* SPDX-License-Identifier: MIT *)
(* eye_records.clh: an edge function of a camera's record, times the record's scale, is off by less than the margin, 1.

   Assumed: C, S and T (corner, step_x, step_y) have met one rounding; (X, Y) lies in the picture, each 0 or from 2^-7 to
   2^14 (no side has more pixels); no difference and no coordinate of the largest ray exceeds 1048577 (set_eye_edge() compares
   what it computed with 2^20), and Q is 2^-40 at least. So the scale, +-1 / (EYE_EDGE_BOUND Q), is neither below 2^-50 nor
   underflows; it is off by at most 7 u of itself, a quotient by 2.5 ulp and a product. Denormals may be kept or flushed.
   Overflow: nothing exceeds 2^124. *)
From Coq Require Import Reals QArith Qreals Lra Lia Psatz.
From Flocq Require Import Core.
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

(* What no device flushes; what nothing exceeds. *)
Definition is_place i := (Nat.eqb i X || Nat.eqb i Y || Nat.eqb i width || Nat.eqb i height)%bool.
Definition may_lose i := if (is_place i || Nat.eqb i scale)%bool then 0%Q else h32Q.
Definition at_most i : Q := if is_place i then 16384 else if Nat.eqb i scale then 2 ^ 61 else 1048577.
Let place i := x i = 0 \/ / 128 <= x i <= 16384.
Hypotheses (place_X : place X) (place_Y : place Y) (place_width : place width) (place_height : place height).
Hypothesis scale_least : / 1125899906842624 <= Rabs (x scale).
Lemma kept : keeps x may_lose.
Proof.
  intros i. assert (h := h32_below). simpl in h. unfold may_lose, is_place.
  assert (P : forall j, place j -> x j = 0 \/ 2 * h32 <= Rabs (x j)).
  { intros j [Z | Z]; [now left | right]. rewrite Rabs_pos_eq; lra. }
  destruct (Nat.eqb_spec i X) as [-> |]; [right; split; auto |].
  destruct (Nat.eqb_spec i Y) as [-> |]; [right; split; auto |].
  destruct (Nat.eqb_spec i width) as [-> |]; [right; split; auto |].
  destruct (Nat.eqb_spec i height) as [-> |]; [right; split; auto |].
  destruct (Nat.eqb_spec i scale) as [-> |]; [right; split; auto; right; lra | now left].
Qed.

Definition lost_of_value : Q := 1 # 18.
Definition lost_of_size : Q := 1 # 36028797018963968.  (* 2^-55 *)
Definition is_lost e := underflowQ u32Q h32Q may_lose at_most (apart 1048577) e.
Lemma lost_is_below : (is_lost value <= lost_of_value /\ is_lost size <= lost_of_size)%Q.
Proof. vm_compute. split; discriminate. Qed.
Definition least_bound := Eval vm_compute in Qred (rate u32Q value size * (1 + (1 # 16384)) / (1 - (1 # 18))).
Lemma rate_is : (rate u32Q value size * (1 + (1 # 16384)) <= least_bound * (1 - (1 # 18)) /\ least_bound <= 1 # 1000000 /\
  6 # 10000000 <= least_bound)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.

Definition inside e := within x (fun i => Q2R (at_most i)) (fun i j => Q2R (apart 1048577 i j)) e.
Lemma off e v : inside e -> computes32 x e v -> Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e +
  Q2R (is_lost e).
Proof.
  intros W C. unfold is_lost. rewrite underflow_is, u32_is, h32_is.
  assert (N := computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near seen32_near x
    (fun i => Q2R (may_lose i)) (keeps_range x _ kept) (keeps_near x _ kept) e v C).
  assert (L := lost_below u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) x (fun i => Q2R (may_lose i)) (keeps_range x _ kept)
    (fun i => Q2R (at_most i)) (fun i j => Q2R (apart 1048577 i j)) e W). lra.
Qed.

Let least_bound_R := Q2R least_bound.
Theorem margin_is_enough c v s : inside value -> inside size -> computes32 x value v -> computes32 x size s ->
  / 1099511627776 <= s -> Q2R least_bound <= Q2R c ->
  Rabs (x scale) * (Q2R c * s) <= 1 + 7 * / 16777216 -> Rabs (v - real x value) <= 1.
Proof.
  assert (X0 := Rabs_pos (x X)). assert (Y0 := Rabs_pos (x Y)).
  assert (W := Rabs_pos_eq (x width) ltac:(lra)). assert (H := Rabs_pos_eq (x height) ltac:(lra)).
  intros Iv Is Cv Cs s_least Hc Hs. apply off in Cv, Cs; auto. assert (P := products).
  assert (same : real x size = permanent x size).
  { cbv [size real permanent]. rewrite !Rabs_mult, W, H. ring. }
  rewrite same in Cs. destruct lost_is_below as [Lv Ls]. apply Qle_Rle in Lv, Ls.
  destruct rate_is as (R1 & R2 & R3). apply Qle_Rle in R1, R2, R3. rewrite !Q2R_mult in R1.
  change (permanent x scaled_size) with (permanent x size * Rabs (x scale)) in P.
  replace (Q2R lost_of_value) with (/ 18) in Lv by (unfold Q2R, lost_of_value; simpl; lra).
  replace (Q2R lost_of_size) with (/ 36028797018963968) in Ls by (unfold Q2R, lost_of_size; simpl; lra).
  replace (Q2R (1 + (1 # 16384))) with (1 + / 16384) in R1 by (unfold Q2R; simpl; lra).
  replace (Q2R (1 - (1 # 18))) with (1 - / 18) in R1 by (unfold Q2R; simpl; lra).
  replace (Q2R (1 # 1000000)) with (/ 1000000) in R2 by (unfold Q2R; simpl; lra).
  replace (Q2R (6 # 10000000)) with (6 / 10000000) in R3 by (unfold Q2R; simpl; lra).
  assert (R : Q2R (rate u32Q value size) = alpha u32 (roundings value) / (1 - alpha u32 (roundings size))).
  { unfold rate. rewrite Q2R_red, Q2R_div, Q2R_minus, Q2R_1, !alpha_is, u32_is by (vm_compute; discriminate). reflexivity. }
  assert (g1 := alpha_below (roundings size) ltac:(vm_compute; lia)). assert (g0 := alpha_at_least (roundings size)).
  assert (a0 := alpha_at_least (roundings value)). assert (g2 : INR (roundings size) <= 16) by (simpl; lra).
  set (a := alpha u32 (roundings value)) in *. set (g := alpha u32 (roundings size)) in *.
  assert (g3 : g <= / 1000) by lra. set (Q := permanent x size) in *. set (t := Rabs (x scale)) in *.
  assert (t0 : 0 <= t) by apply Rabs_pos. assert (Q0 : 0 <= Q) by apply permanent_positive.
  set (r := a / (1 - g)) in *. rewrite R in R1. apply between in Cs.
  assert (r0 : 0 <= r) by (unfold r, Rdiv; apply Rmult_le_pos; [auto | left; apply Rinv_0_lt_compat; lra]).
  assert (aQ : a * Q <= r * (s + / 36028797018963968)).
  { unfold r. replace (a * Q) with (a / (1 - g) * ((1 - g) * Q)) by (field; lra). apply Rmult_le_compat_l; [exact r0 | lra]. }
  assert (aP := Rmult_le_compat_l _ _ _ a0 P). assert (aQt := Rmult_le_compat_r _ _ _ t0 aQ).
  assert (ts0 : 0 <= t * s) by (apply Rmult_le_pos; lra).
  assert (tc := Rmult_le_compat_l _ _ _ ts0 Hc).
  assert (tL : least_bound_R * (t * s) <= 1 + 7 * / 16777216) by (unfold least_bound_R; lra).
  assert (small : s + / 36028797018963968 <= (1 + / 32768) * s) by lra.
  assert (t_r : r * (t * s) * (1 + / 16384) <= (1 - / 18) * (1 + 7 * / 16777216)).
  { assert (G := Rmult_le_compat_r (t * s) _ _ ts0 R1). unfold least_bound_R in tL. lra. }
  assert (small' := Rmult_le_compat_l _ _ _ (Rmult_le_pos _ _ r0 t0) small). lra.
Qed.
End Edge.
Lemma kernel_is_enough : (least_bound <= bound_constant)%Q.
Proof. vm_compute. discriminate. Qed.
Definition constants := Eval vm_compute in shown least_bound bound_constant.
Print constants.
Definition checked := (margin_is_enough, kernel_is_enough).
Print Assumptions checked.
