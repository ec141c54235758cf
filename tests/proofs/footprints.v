(* SPDX-License-Identifier: MIT *)
(* footprint.h, grid_coordinate(): the computed half axes of a footprint and the slack around them contain its points (docs/
   numerics.md, 9).
     axis_near       a half axis is off by 27.2 u of its magnitudes times the scale;
     slack_is_large  the slack, without its term with k, is more than what all points are off by.

   Assumed: g, a row or in perspective row - X row_z, is off by at most 8 u of `size`, which no |g| exceeds but for 4 u of
   it; the scale, 1 or 1 / W, by 15 u of itself (frame_errors.v: 9.1 u); stretch is at least 1 and k at least 0; no
     result is
   below 2^-126 unless it is 0. In prose (footprint.h): in perspective the rest is at most (|u| + |v|) k / (1 - k), and four
   errors of a point are added. Overflow: no footprint is used whose reach is 1e30.
   loose: 64 u also serves the position's own roundings, and no test of a footprint is that near to a margin. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition g_x := 0%nat.
Definition g_y := 1%nat.
Definition g_z := 2%nat.
Definition size_x := 3%nat.
Definition size_y := 4%nat.
Definition size_z := 5%nat.
Definition U_x := 6%nat.
Definition U_y := 7%nat.
Definition U_z := 8%nat.
Definition V_x := 9%nat.
Definition V_y := 10%nat.
Definition V_z := 11%nat.
Definition spread := 12%nat.
Definition scale := 13%nat.
Definition stretch := 14%nat.
Definition k := 15%nat.
Definition half_u :=
  Mul (Add (Add (Mul (Given U_x 0) (Given g_x 0)) (Mul (Given U_y 0) (Given g_y 0))) (Mul (Given U_z 0) (Given g_z
    0))) (Given scale 0).
Definition half_v :=
  Mul (Add (Add (Mul (Given V_x 0) (Given g_x 0)) (Mul (Given V_y 0) (Given g_y 0))) (Mul (Given V_z 0) (Given g_z
    0))) (Given scale 0).
Definition slack :=
  Mul (Add (Mul (Add (Abs half_u) (Abs half_v)) (Given k 0)) (Mul (Add (Mul (Add (Add (Given size_x 0) (Given size_y
    0)) (Given size_z 0)) (Given spread 0)) (Times (1 # 262144) (Add (Add (Mul (Add (Abs (Given U_x 0)) (Abs (Given
    V_x 0))) (Given size_x 0)) (Mul (Add (Abs (Given U_y 0)) (Abs (Given V_y 0))) (Given size_y 0))) (Mul (Add (Abs
    (Given U_z 0)) (Abs (Given V_z 0))) (Given size_z 0))))) (Given scale 0))) (Times (4236247 # 4194304) (Given
    stretch 0)).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).

Section Footprint.
Variable x : nat -> R.
Let s := x scale.
Variables G_x G_y G_z T : R.  (* the real row and scale *)
Let right g size G := Rabs (x g - G) <= 8 * u * x size /\ Rabs (x g) <= (1 + 4 * u) * x size.
Hypotheses (x_right : right g_x size_x G_x) (y_right : right g_y size_y G_y) (z_right : right g_z size_z G_z).
Hypotheses (s0 : 0 <= s) (T_near : Rabs (s - T) <= 15 * u * s).
Let magnitudes p q r := Rabs (x p) * x size_x + Rabs (x q) * x size_y + Rabs (x r) * x size_z.
Definition dot p q r := p * G_x + q * G_y + r * G_z.

Lemma sizes0 : 0 <= x size_x /\ 0 <= x size_y /\ 0 <= x size_z.
Proof.
  destruct x_right as [A _], y_right as [B _], z_right as [C _].
  apply (Rle_trans _ _ _ (Rabs_pos _)) in A, B, C. lra.
Qed.
Lemma row_below g size G : right g size G -> Rabs G <= (1 + 13 * u) * x size.
Proof.
  intros [A B]. assert (Z := Rle_trans _ _ _ (Rabs_pos _) A). assert (T' := Rabs_triang (x g) (- (x g - G))).
  rewrite Rabs_Ropp in T'. replace (x g + - (x g - G)) with G in T' by ring. lra. Qed.

Theorem axis_near e v p q r : e = Mul (Add (Add (Mul (Given p 0) (Given g_x 0)) (Mul (Given q 0) (Given g_y 0)))
    (Mul (Given r 0) (Given g_z 0))) (Given scale 0) -> computed x e v ->
  Rabs (v - T * dot (x p) (x q) (x r)) <= 272 / 10 * u * (s * magnitudes p q r).
Proof.
  intros -> C. apply near in C. assert (A := alpha_below 4 ltac:(lia)). simpl INR in A. cbn -[u32 alpha] in C. fold s in C.
  rewrite (Rabs_pos_eq s) in C by assumption. destruct sizes0 as (zx & zy & zz).
  assert (term : forall i g size G, right g size G -> 0 <= x size -> Rabs (x i * x g - x i * G) <= 8 * u * (Rabs (x i) *
    x size) /\
    Rabs (x i) * Rabs (x g) <= (1 + 4 * u) * (Rabs (x i) * x size) /\ Rabs (x i * G) <= (1 + 13 * u) * (Rabs (x i) * x
      size) /\
    0 <= Rabs (x i) * x size).
  { intros i g size G H z0. assert (B := row_below _ _ _ H). destruct H as [H1 H2].
    replace (x i * x g - x i * G) with (x i * (x g - G)) by ring. rewrite !Rabs_mult.
    assert (G1 := Rmult_le_compat_l _ _ _ (Rabs_pos (x i)) H1). assert (G2 := Rmult_le_compat_l _ _ _ (Rabs_pos (x i)) H2).
    assert (G3 := Rmult_le_compat_l _ _ _ (Rabs_pos (x i)) B). assert (P := Rmult_le_pos _ _ (Rabs_pos (x i)) z0).
    repeat split; lra. }
  destruct (term p _ _ _ x_right zx) as (N1 & I1 & R1 & P1). destruct (term q _ _ _ y_right zy) as (N2 & I2 & R2 & P2).
  destruct (term r _ _ _ z_right zz) as (N3 & I3 & R3 & P3).
  set (M := magnitudes p q r) in *. assert (M_is : M = Rabs (x p) * x size_x + Rabs (x q) * x size_y + Rabs (x r) * x
    size_z) by reflexivity.
  assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra).
  assert (D : Rabs (x p * x g_x + x q * x g_y + x r * x g_z - dot (x p) (x q) (x r)) <= 8 * u * M).
  { unfold dot. apply between in N1, N2, N3. apply Rabs_le. lra. }
  assert (d : Rabs (dot (x p) (x q) (x r)) <= (1 + 13 * u) * M).
  { unfold dot. apply between in R1, R2, R3. apply Rabs_le. lra. }
  assert (sD := Rmult_le_compat_l s _ _ s0 D). rewrite <- (Rabs_pos_eq s) in sD at 1 by assumption.
  rewrite <- Rabs_mult in sD.
  assert (Td := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) T_near d). rewrite <- Rabs_mult in Td.
  match type of C with _ <= _ * ?p => set (Q := p) in * end.
  assert (Q1 : Q <= (1 + 4 * u) * (s * M)).
  { unfold Q. assert (G := Rmult_le_compat_r s (Rabs (x p) * Rabs (x g_x) + Rabs (x q) * Rabs (x g_y) + Rabs (x r) * Rabs
    (x g_z))
      ((1 + 4 * u) * M) s0 ltac:(lra)). lra. }
  assert (Q0 : 0 <= Q).
  { unfold Q. apply Rmult_le_pos; [| assumption]. repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos. }
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 4) Q0 A Q1). apply between in C, sD, Td. apply Rabs_le. lra.
Qed.

(* The slack less its term with k. *)
Definition of_sizes : Q := match slack with Mul (Add _ (Mul (Add _ (Times c _)) _)) _ => c | _ => 0%Q end.
Definition inflation : Q := match slack with Mul _ (Times c _) => c | _ => 0%Q end.
Definition least_sizes : Q := 270 # 167772160.
Theorem slack_is_large a b d_x d_y d_z c w v1 v2 :
  computed x half_u v1 -> computed x half_v v2 -> -1 <= a <= 1 -> -1 <= b <= 1 ->
  Rabs d_x <= x spread -> Rabs d_y <= x spread -> Rabs d_z <= x spread -> Q2R least_sizes <= Q2R c ->
  101 / 100 * (1 - 10 * u) * (s * ((x size_x + x size_y + x size_z) * x spread + Q2R c * (magnitudes U_x U_y U_z +
    magnitudes V_x V_y V_z))) <= w ->
  Rabs (T * dot (a * x U_x + b * x V_x + d_x) (a * x U_y + b * x V_y + d_y) (a * x U_z + b * x V_z + d_z) - (a * v1 + b *
    v2)) <= w.
Proof.
  intros C1 C2 Ha Hb D1 D2 D3 Hc Hw. assert (N1 := axis_near _ _ _ _ _ eq_refl C1).
  assert (N2 := axis_near _ _ _ _ _ eq_refl C2).
  replace (Q2R least_sizes) with (27 * u) in Hc by (unfold Q2R, least_sizes; simpl; lra). destruct sizes0 as (zx & zy & zz).
  set (M1 := magnitudes U_x U_y U_z) in *. set (M2 := magnitudes V_x V_y V_z) in *.
  assert (m0 : forall p q r, 0 <= magnitudes p q r).
  { intros. unfold magnitudes. repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; auto using Rabs_pos. }
  assert (P1 := Rmult_le_pos _ _ s0 (m0 U_x U_y U_z)). assert (P2 := Rmult_le_pos _ _ s0 (m0 V_x V_y V_z)).
  fold M1 in P1. fold M2 in P2.
  assert (sc := Rmult_le_compat_r (s * M1 + s * M2) _ _ ltac:(lra) Hc).
  assert (times : forall t y z, -1 <= t <= 1 -> Rabs y <= z -> Rabs (t * y) <= z).
  { intros t y z Ht Hy. rewrite Rabs_mult. assert (t1 : Rabs t <= 1) by (apply Rabs_le; lra).
    assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) t1 Hy). lra. }
  rewrite Rabs_minus_sym in N1, N2. assert (A1 := times _ _ _ Ha N1). assert (A2 := times _ _ _ Hb N2).
  set (sp := x spread) in *. assert (sp0 : 0 <= sp) by (eapply Rle_trans; [apply Rabs_pos | exact D1]).
  assert (dG : Rabs (dot d_x d_y d_z) <= (1 + 13 * u) * ((x size_x + x size_y + x size_z) * sp)).
  { assert (B1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) D1 (row_below _ _ _ x_right)).
    assert (B2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) D2 (row_below _ _ _ y_right)).
    assert (B3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) D3 (row_below _ _ _ z_right)).
    rewrite <- Rabs_mult in B1, B2, B3. unfold dot. apply between in B1, B2, B3. apply Rabs_le. lra. }
  assert (T_in : Rabs T <= (1 + 15 * u) * s) by (apply between in T_near; apply Rabs_le; lra).
  assert (A3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) T_in dG). rewrite <- Rabs_mult in A3.
  assert (P3 : 0 <= s * ((x size_x + x size_y + x size_z) * sp)) by (repeat apply Rmult_le_pos; lra).
  replace (T * dot (a * x U_x + b * x V_x + d_x) (a * x U_y + b * x V_y + d_y) (a * x U_z + b * x V_z + d_z) - (a * v1 +
    b * v2)) with
    (a * (T * dot (x U_x) (x U_y) (x U_z) - v1) + (b * (T * dot (x V_x) (x V_y) (x V_z) - v2) + T * dot d_x d_y d_z)) by
      (unfold dot; ring).
  apply between in A1, A2, A3. apply Rabs_le. lra.
Qed.
End Footprint.
Lemma kernels_are_enough : (least_sizes <= of_sizes /\ (101 # 100) * (1 - (1 # 16777216)) <= inflation)%Q.
Proof. vm_compute. split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_sizes of_sizes.
Print constants.
Definition checked := (axis_near, slack_is_large, kernels_are_enough).
Print Assumptions checked.
