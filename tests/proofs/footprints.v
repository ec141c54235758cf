(* SPDX-License-Identifier: MIT *)
(* footprint.h, grid_coordinate(): the computed half axes of a footprint and the slack around them contain its points (docs/
   numerics.md, 9).
     axis_near       a half axis is off by 27.2 u of its magnitudes times the scale, and by what underflow takes;
     slack_is_large  the slack, without its term with k, is more than what all points are off by.

   Assumed: g, a row or in perspective row - X row_z, is off by at most 8 u of `size`, which no |g| exceeds but for 4 u of
   it; the scale, 1 or 1 / W, by 15 u of itself (frame_errors.v: 9.1 u); stretch is at least 1 and k at least 0;
   the spread is 2^-100 at least, as both kinds add 1e-30, and the scale 1/4, as W is at most 2. Denormals may be kept or
   flushed: FOOTPRINT_NEAR, added to each size and to their sum, is more than that takes of both axes; a quarter of it is
   left for the slack's own operations (prose: they lose a few 2^-126, and so much of a size, below 2^-23 of the spread's). In prose (footprint.h): in perspective the rest is at most (|u| + |v|) k / (1 - k), and four
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
  Mul (Add (Mul (Add (Abs half_u) (Abs half_v)) (Given k 0)) (Mul (Add (Add (Mul (Add (Add (Add (Const (1 #
    1237940039285380274899124224)) (Given size_x 0)) (Add (Const (1 # 1237940039285380274899124224)) (Given size_y
    0))) (Add (Const (1 # 1237940039285380274899124224)) (Given size_z 0))) (Given spread 0)) (Times (1 # 262144)
    (Add (Add (Mul (Add (Abs (Given U_x 0)) (Abs (Given V_x 0))) (Add (Const (1 # 1237940039285380274899124224))
    (Given size_x 0))) (Mul (Add (Abs (Given U_y 0)) (Abs (Given V_y 0))) (Add (Const (1 #
    1237940039285380274899124224)) (Given size_y 0)))) (Mul (Add (Abs (Given U_z 0)) (Abs (Given V_z 0))) (Add
    (Const (1 # 1237940039285380274899124224)) (Given size_z 0)))))) (Const (1 # 1237940039285380274899124224)))
    (Given scale 0))) (Times (4236247 # 4194304) (Given stretch 0)).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).

Section Footprint.
Variable x : nat -> R.
Let s := x scale.
Local Notation near_ := (/ 1237940039285380274899124224).  (* FOOTPRINT_NEAR, 2^-90 *)
Let big i := x i + near_.
Variables G_x G_y G_z T : R.  (* the real row and scale *)
Let right g size G := Rabs (x g - G) <= 8 * u * big size /\ Rabs (x g) <= (1 + 4 * u) * big size.
Hypotheses (x_right : right g_x size_x G_x) (y_right : right g_y size_y G_y) (z_right : right g_z size_z G_z).
Hypotheses (s_in : / 4 <= s) (T_near : Rabs (s - T) <= 15 * u * s).
Hypotheses (size_x_in : 0 <= x size_x) (size_y_in : 0 <= x size_y) (size_z_in : 0 <= x size_z).
Let s0 : 0 <= s := Rle_trans _ _ _ (Rlt_le _ _ (Rinv_0_lt_compat 4 ltac:(lra))) s_in.
Let magnitudes p q r := Rabs (x p) * big size_x + Rabs (x q) * big size_y + Rabs (x r) * big size_z.
Definition dot p q r := p * G_x + q * G_y + r * G_z.

Lemma sizes0 : 0 <= big size_x /\ 0 <= big size_y /\ 0 <= big size_z.
Proof.
  unfold big. lra.
Qed.
Lemma row_below g size G : right g size G -> Rabs G <= (1 + 13 * u) * big size.
Proof.
  intros [A B]. assert (Z := Rle_trans _ _ _ (Rabs_pos _) A). assert (T' := Rabs_triang (x g) (- (x g - G))).
  rewrite Rabs_Ropp in T'. replace (x g + - (x g - G)) with G in T' by ring. lra. Qed.

(* What underflow takes of one axis, times the scale. *)
Let all_sizes := big size_x + big size_y + big size_z.
Let lost_of p q r := 3 * h32 * (Rabs (x p) + Rabs (x q) + Rabs (x r)) + 3 * h32 * all_sizes + / 6000000000000000000000000000.
Theorem axis_near e v p q r : e = Mul (Add (Add (Mul (Given p 0) (Given g_x 0)) (Mul (Given q 0) (Given g_y 0)))
    (Mul (Given r 0) (Given g_z 0))) (Given scale 0) -> computes32 x e v ->
  Rabs (v - T * dot (x p) (x q) (x r)) <= s * (272 / 10 * u * magnitudes p q r + lost_of p q r).
Proof.
  intros -> C. assert (h := h32_positive). assert (h1 := h32_below). simpl in h1. destruct sizes0 as (zx & zy & zz).
  set (sum := Add (Add (Mul (Given p 0) (Given g_x 0)) (Mul (Given q 0) (Given g_y 0))) (Mul (Given r 0) (Given g_z 0))) in *.
  destruct (step32_mul _ _ _ _ C) as (a & t & Ca & Ct & N). apply given32_is in Ct. subst t. fold s in N.
  apply near32 in Ca. unfold lost32 in Ca. cbn -[u32 h32 alpha] in Ca. unfold of_product in Ca.
  assert (A := alpha_below 3 ltac:(lia)). simpl INR in A. assert (z : alpha u32 0 = 0) by (unfold alpha; simpl; lra).
  assert (Z3 := alpha_at_least 3). rewrite ?z, !u32_value in Ca. rewrite u32_value in A, Z3.
  assert (term : forall i g size G, right g size G -> 0 <= big size -> Rabs (x i * x g - x i * G) <= 8 * u * (Rabs (x i) *
    big size) /\
    Rabs (x i) * Rabs (x g) <= (1 + 4 * u) * (Rabs (x i) * big size) /\ Rabs (x i * G) <= (1 + 13 * u) * (Rabs (x i) * big
      size) /\
    0 <= Rabs (x i) * big size).
  { intros i g size G H z0. assert (B := row_below _ _ _ H). destruct H as [H1 H2].
    replace (x i * x g - x i * G) with (x i * (x g - G)) by ring. rewrite !Rabs_mult.
    assert (G1 := Rmult_le_compat_l _ _ _ (Rabs_pos (x i)) H1). assert (G2 := Rmult_le_compat_l _ _ _ (Rabs_pos (x i)) H2).
    assert (G3 := Rmult_le_compat_l _ _ _ (Rabs_pos (x i)) B). assert (P := Rmult_le_pos _ _ (Rabs_pos (x i)) z0).
    repeat split; lra. }
  destruct (term p _ _ _ x_right zx) as (N1 & I1 & R1 & P1). destruct (term q _ _ _ y_right zy) as (N2 & I2 & R2 & P2).
  destruct (term r _ _ _ z_right zz) as (N3 & I3 & R3 & P3).
  (* What underflow takes of the sum. *)
  assert (hg : forall g size G, right g size G -> 0 <= x size -> 0 <= h32 * Rabs (x g) <= h32 * (1001 / 1000 * big size)).
  { intros g size G [_ H] B. unfold big in *. split; [apply Rmult_le_pos; [lra | apply Rabs_pos] |].
    apply Rmult_le_compat_l; lra. }
  assert (L1 := hg _ _ _ x_right size_x_in). assert (L2 := hg _ _ _ y_right size_y_in).
  assert (L3 := hg _ _ _ z_right size_z_in). clear hg.
  assert (hu := fun i => Rmult_le_pos _ _ (Rlt_le _ _ h) (Rabs_pos (x i))). assert (U1 := hu p). assert (U2 := hu q).
  assert (U3 := hu r). clear hu. assert (hh : 0 <= h32 * h32 <= h32 * / 100) by (split; [apply Rmult_le_pos | apply
    Rmult_le_compat_l]; lra).
  set (M := magnitudes p q r) in *. assert (M_is : M = Rabs (x p) * big size_x + Rabs (x q) * big size_y + Rabs (x r) * big
    size_z) by reflexivity.
  set (H := Rabs (x p) + Rabs (x q) + Rabs (x r)) in *. assert (H_is : h32 * H = h32 * Rabs (x p) + h32 * Rabs (x q) + h32 *
    Rabs (x r)) by (unfold H; ring).
  assert (M0 : 0 <= M) by lra.
  match type of Ca with _ <= _ * ?p + _ => set (Q := p) in * end.
  assert (Q1 : Q <= (1 + 4 * u) * M) by (unfold Q; lra).
  assert (Q0 : 0 <= Q) by (unfold Q; repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos).
  assert (E := Rmult_le_compat _ _ _ _ Z3 Q0 A Q1).
  assert (hS_is : h32 * all_sizes = h32 * big size_x + h32 * big size_y + h32 * big size_z) by (unfold all_sizes; ring).
  set (A' := all_sizes) in *. assert (A0 : 0 <= h32 * A') by lra.
  set (few := / 6400000000000000000000000000).
  assert (D : Rabs (a - dot (x p) (x q) (x r)) <= 1101 / 100 * u * M + (101 / 100 * (h32 * H) + 102 / 100 * (h32 * A') + few)).
  { unfold dot, few. apply between in N1, N2, N3, Ca. apply Rabs_le. lra. }
  assert (d : Rabs (dot (x p) (x q) (x r)) <= (1 + 13 * u) * M).
  { unfold dot. apply between in R1, R2, R3. apply Rabs_le. lra. }
  set (dd := dot (x p) (x q) (x r)) in *. assert (T_off : Rabs ((s - T) * dd) <= 15 * u * s * ((1 + 13 * u) * M)).
  { rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos. }
  assert (sD := Rmult_le_compat_l s _ _ s0 D).
  assert (a_in : Rabs a <= (1 + 25 * u) * M + (101 / 100 * (h32 * H) + 102 / 100 * (h32 * A') + few)).
  { replace a with ((a - dd) + dd) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra. }
  assert (sa := Rmult_le_compat_l s _ _ s0 a_in).
  assert (sD' : Rabs (a * s - s * dd) <= s * (1101 / 100 * u * M + (101 / 100 * (h32 * H) + 102 / 100 * (h32 * A') + few))).
  { replace (a * s - s * dd) with (s * (a - dd)) by ring. rewrite Rabs_mult, (Rabs_pos_eq s) by assumption. exact sD. }
  assert (as_ : Rabs (a * s) <= s * ((1 + 25 * u) * M + (101 / 100 * (h32 * H) + 102 / 100 * (h32 * A') + few))).
  { rewrite Rabs_mult, (Rabs_pos_eq s), (Rmult_comm (Rabs a)) by assumption. exact sa. }
  rewrite (Rabs_pos_eq s) in N by assumption.
  assert (M_h : h32 * M <= / 100000000000000000000 * M) by (apply Rmult_le_compat_r; lra).
  assert (hH0 : 0 <= h32 * H) by lra. assert (few0 : 0 < few <= / 1000) by (unfold few; lra).
  assert (ha : h32 * Rabs a <= h32 * ((1 + 25 * u) * M + (101 / 100 * (h32 * H) + 102 / 100 * (h32 * A') + few))) by (apply Rmult_le_compat_l; lra).
  assert (hhA : h32 * (h32 * A') <= / 1000 * (h32 * A')) by (apply Rmult_le_compat_r; lra).
  assert (hhH : h32 * (h32 * H) <= / 1000 * (h32 * H)) by (apply Rmult_le_compat_r; lra).
  assert (hf : h32 * few <= h32 * / 1000) by (apply Rmult_le_compat_l; lra).
  assert (sh0 : 0 <= s * h32) by (apply Rmult_le_pos; lra).
  (* 2 h (|a| + s + 1), by the scale, which is at least 1/4. *)
  assert (rest : 2 * h32 * (Rabs a + s + 1) <= s * (/ 10000000000000 * M + (/ 100 * (h32 * H) + / 100 * (h32 * A') + 20 * h32))).
  { assert (G : / 4 * (/ 10000000000000 * M + (/ 100 * (h32 * H) + / 100 * (h32 * A') + 10 * h32)) <= s * (/ 10000000000000 * M + (/ 100 *
      (h32 * H) + / 100 * (h32 * A') + 10 * h32))) by (apply Rmult_le_compat_r; lra). lra. }
  replace (v - T * dd) with ((v - a * s) + ((a * s - s * dd) + (s - T) * dd)) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. assert (T1 := Rabs_triang (a * s - s * dd) ((s - T) * dd)).
  assert (sA : 0 <= s * (h32 * A')) by (apply Rmult_le_pos; lra).
  unfold lost_of. fold H. fold A'. assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra).
  assert (sH : 0 <= s * (h32 * H)) by (apply Rmult_le_pos; lra).
  assert (sf : s * few = / 6400000000000000000000000000 * s) by (unfold few; ring).
  assert (sh := Rmult_le_compat_l s _ _ s0 h1). lra.
Qed.

(* The slack less its term with k. *)
Definition of_sizes : Q := match slack with Mul (Add _ (Mul (Add (Add _ (Times c _)) _) _)) _ => c | _ => 0%Q end.
Definition inner := match slack with Mul (Add _ (Mul i _)) _ => i | _ => Const 0 end.
Definition of_nothing : Q := match inner with Add _ (Const c) => c | _ => 0%Q end.
Definition inflation : Q := match slack with Mul _ (Times c _) => c | _ => 0%Q end.
Definition least_sizes : Q := 271 # 167772160.
Theorem slack_is_large a b d_x d_y d_z c w v1 v2 :
  computes32 x half_u v1 -> computes32 x half_v v2 -> -1 <= a <= 1 -> -1 <= b <= 1 ->
  / 1267650600228229401496703205376 <= x spread -> Rabs d_x <= x spread -> Rabs d_y <= x spread -> Rabs d_z <= x spread -> Q2R least_sizes <= Q2R c ->
  101 / 100 * (1 - 10 * u) * (s * ((big size_x + big size_y + big size_z) * x spread + Q2R c * (magnitudes U_x U_y U_z +
    magnitudes V_x V_y V_z) + 3 / 4 * near_)) <= w ->
  Rabs (T * dot (a * x U_x + b * x V_x + d_x) (a * x U_y + b * x V_y + d_y) (a * x U_z + b * x V_z + d_z) - (a * v1 + b *
    v2)) <= w.
Proof.
  intros C1 C2 Ha Hb sp_least D1 D2 D3 Hc Hw. assert (N1 := axis_near _ _ _ _ _ eq_refl C1).
  assert (N2 := axis_near _ _ _ _ _ eq_refl C2).
  replace (Q2R least_sizes) with (271 / 10 * u) in Hc by (unfold Q2R, least_sizes; simpl; lra). destruct sizes0 as (zx & zy & zz).
  (* What underflow takes of both axes. *)
  assert (lost_in : lost_of U_x U_y U_z + lost_of V_x V_y V_z <= / 10 * u * (magnitudes U_x U_y U_z + magnitudes V_x V_y V_z) +
    / 1000000 * (all_sizes * x spread) + / 3000000000000000000000000000).
  { unfold lost_of, magnitudes. assert (h1 := h32_below). simpl in h1. assert (h := h32_positive).
    assert (one : forall i size, 0 <= x size -> 3 * h32 * Rabs (x i) <= / 10 * u * (Rabs (x i) * big size)).
    { intros i size B. assert (G := Rmult_le_compat_l (Rabs (x i)) near_ (big size) (Rabs_pos _) ltac:(unfold big; lra)).
      assert (G2 := Rmult_le_compat_r (Rabs (x i)) _ _ (Rabs_pos _) h1). assert (G3 := Rabs_pos (x i)). lra. }
    assert (A0 : 0 <= all_sizes) by (unfold all_sizes; lra).
    assert (hA0 : 0 <= h32 * all_sizes) by (apply Rmult_le_pos; lra).
    assert (hA : h32 * all_sizes <= / 10000000 * (all_sizes * x spread)).
    { assert (G := Rmult_le_compat_l all_sizes _ _ A0 sp_least). assert (G2 := Rmult_le_compat_r all_sizes _ _ A0 h1). lra. }
    assert (O1 := one U_x _ size_x_in). assert (O2 := one U_y _ size_y_in).
    assert (O3 := one U_z _ size_z_in). assert (O4 := one V_x _ size_x_in).
    assert (O5 := one V_y _ size_y_in). assert (O6 := one V_z _ size_z_in). lra. }
  unfold all_sizes in lost_in. assert (s_lost := Rmult_le_compat_l s _ _ s0 lost_in).
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
  assert (dG : Rabs (dot d_x d_y d_z) <= (1 + 13 * u) * ((big size_x + big size_y + big size_z) * sp)).
  { assert (B1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) D1 (row_below _ _ _ x_right)).
    assert (B2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) D2 (row_below _ _ _ y_right)).
    assert (B3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) D3 (row_below _ _ _ z_right)).
    rewrite <- Rabs_mult in B1, B2, B3. unfold dot. apply between in B1, B2, B3. apply Rabs_le. lra. }
  assert (T_in : Rabs T <= (1 + 15 * u) * s) by (apply between in T_near; apply Rabs_le; lra).
  assert (A3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) T_in dG). rewrite <- Rabs_mult in A3.
  assert (P3 : 0 <= s * ((big size_x + big size_y + big size_z) * sp)) by (repeat apply Rmult_le_pos; lra).
  replace (T * dot (a * x U_x + b * x V_x + d_x) (a * x U_y + b * x V_y + d_y) (a * x U_z + b * x V_z + d_z) - (a * v1 +
    b * v2)) with
    (a * (T * dot (x U_x) (x U_y) (x U_z) - v1) + (b * (T * dot (x V_x) (x V_y) (x V_z) - v2) + T * dot d_x d_y d_z)) by
      (unfold dot; ring).
  apply between in A1, A2, A3. apply Rabs_le. lra.
Qed.
End Footprint.
Lemma kernels_are_enough : (least_sizes <= of_sizes /\ (101 # 100) * (1 - (1 # 16777216)) <= inflation /\
  1 # 2 ^ 90 <= of_nothing)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_sizes of_sizes.
Print constants.
Definition checked := (axis_near, slack_is_large, kernels_are_enough).
Print Assumptions checked.
