(* SPDX-License-Identifier: MIT *)
(* sweeps.cl: the ground where a vertex's own ray meets edges, against the vertex's height less or plus a margin; and what bounds
   the ground across a strip and between two lines (docs/numerics.md, 16).
     lit_is_above, dark_is_below   of the next lines, with near_margin: the real ground is below, or above, the ray;
     walked_near                   along the whole ray, walked alone: 24 u of the greatest height and 8 u of the climb;
     across_a_strip, greatest_at_ends   a line raised or lowered at both ends; the greatest of straight lines;
     rising_bends, falling_bends, kernels_bends, bent_is_below   where a ray crosses a diagonal or a row, how much its slope falls,
                                   and that the ground is above the straight line by a quarter of that at most;
     bend_near, sum_of_bends       the same as computed: 34 u H of three.

   Assumed: heights are 0 to H, up to 2^21, each off by one rounding (RasterCopies subtracts the lowest), a ray's climb C is
   up to 2^31 in all; the host rounds shares of an edge and the climb up to it once (set_crossings()); along a ray that is
   walked a share is rounded once and a distance twice; the margin is SWEEP_CROSSING_ERROR (H + C) + SWEEP_LOST at least
   (set_margins() has 1.01 of the first in double, and rounds the sum once), up to 2^31. Denormals may be kept or flushed. Between two lines
   heights are the floats that are kept. In prose: the roundings of bounds across a strip, 70 u H + 13 u C with the bends' of the
   margin's 128 u and 32 u, in which walked_near has room; that a ray crosses at most one row and two diagonals between two
   lines; unevenness; what lit and dark mean. *)
From Coq Require Import Reals QArith Qreals Lra Lia Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition share_low := 0%nat.
Definition low := 1%nat.
Definition share_high := 2%nat.
Definition high := 3%nat.
Definition climb := 4%nat.
Definition share := 5%nat.
Definition farther := 6%nat.
Definition height := 7%nat.
Definition near_margin := 8%nat.
Definition h_x := 9%nat.
Definition h_y := 10%nat.
Definition h_z := 11%nat.
Definition h_w := 12%nat.
Definition n_x := 13%nat.
Definition n_y := 14%nat.
Definition n_z := 15%nat.
Definition n_w := 16%nat.
Definition slope := 17%nat.
Definition greater_1 := 18%nat.
Definition greater_2 := 19%nat.
Definition greater_3 := 20%nat.
Definition greater_4 := 21%nat.
Definition greater_5 := 22%nat.
Definition greater_6 := 23%nat.
Definition greater_7 := 24%nat.
Definition greater_8 := 25%nat.
Definition greater_9 := 26%nat.
Definition greater_10 := 27%nat.
Definition greater_11 := 28%nat.
Definition greater_12 := 29%nat.
Definition ground :=
  Sub (Add (Mul (Given high 1) (Given share_high 1)) (Mul (Given low 1) (Given share_low 1))) (Given climb 1).
Definition walked :=
  Sub (Add (Given low 1) (Mul (Given share 1) (Sub (Given high 1) (Given low 1)))) (Mul (Given climb 1) (Given
    farther 2)).
Definition below :=
  Sub (Given height 1) (Given near_margin 0).
Definition above :=
  Add (Given height 1) (Given near_margin 0).
Definition of_sizes :=
  Const (7 # 8388608).
Definition of_nothing :=
  Const (1 # 1208925819614629174706176).
Definition greater_1_one :=
  Const (0 # 1).
Definition greater_1_other :=
  Mul (Add (Diff h_x n_x) (Diff n_y h_y)) (Times (1 # 4) (Sub (Const (1 # 1)) (Given slope 1))).
Definition greater_2_one :=
  greater_1_one.
Definition greater_2_other :=
  Mul (Add (Diff h_y n_y) (Diff n_z h_z)) (Times (1 # 4) (Sub (Const (1 # 1)) (Given slope 1))).
Definition greater_3_one :=
  greater_2_one.
Definition greater_3_other :=
  Mul (Times (1 # 4) (Given slope 1)) (Sub (Diff h_y h_x) (Diff n_z n_y)).
Definition greater_4_one :=
  greater_3_one.
Definition greater_4_other :=
  Mul (Add (Diff h_z n_z) (Diff n_w h_w)) (Times (1 # 4) (Sub (Const (1 # 1)) (Given slope 1))).
Definition greater_5_one :=
  greater_4_one.
Definition greater_5_other :=
  Mul (Times (1 # 4) (Given slope 1)) (Sub (Diff h_z h_y) (Diff n_w n_z)).
Definition greater_6_one :=
  Add (Add (Given greater_1 0) (Given greater_2 0)) (Given greater_3 0).
Definition greater_6_other :=
  Add (Add (Given greater_2 0) (Given greater_4 0)) (Given greater_5 0).
Definition rising := Given greater_6 0.
Definition greater_7_one :=
  greater_5_one.
Definition greater_7_other :=
  Mul (Add (Diff h_x n_x) (Diff n_y h_y)) (Times (1 # 4) (Sub (Const (-1 # 1)) (Given slope 1))).
Definition greater_8_one :=
  greater_7_one.
Definition greater_8_other :=
  Mul (Add (Diff h_y n_y) (Diff n_z h_z)) (Times (1 # 4) (Sub (Const (-1 # 1)) (Given slope 1))).
Definition greater_9_one :=
  greater_8_one.
Definition greater_9_other :=
  Mul (Times (1 # 4) (Given slope 1)) (Sub (Diff n_y n_x) (Diff h_z h_y)).
Definition greater_10_one :=
  greater_9_one.
Definition greater_10_other :=
  Mul (Add (Diff h_z n_z) (Diff n_w h_w)) (Times (1 # 4) (Sub (Const (-1 # 1)) (Given slope 1))).
Definition greater_11_one :=
  greater_10_one.
Definition greater_11_other :=
  Mul (Times (1 # 4) (Given slope 1)) (Sub (Diff n_z n_y) (Diff h_w h_z)).
Definition greater_12_one :=
  Add (Add (Given greater_7 0) (Given greater_8 0)) (Given greater_9 0).
Definition greater_12_other :=
  Add (Add (Given greater_8 0) (Given greater_10 0)) (Given greater_11 0).
Definition falling := Given greater_12 0.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation few := (/ 4835703278458516698824704).  (* 2^-82 *)
Definition value_of e : Q := match e with Const c => c | _ => 0%Q end.
Definition lost : Q := 1 # 4835703278458516698824704.

Section Ray.
Variable x : nat -> R.  (* the real numbers: shares, climbs and heights before they are rounded *)
Variables H C : R.
Hypotheses (H_in : 0 <= H <= 2097152) (C_in : 0 <= C <= 2147483648).
Hypotheses (low_in : 0 <= x low <= H) (high_in : 0 <= x high <= H) (height_in : 0 <= x height <= H).

Lemma limit_is : Q2R 2147483648 = 2147483648.
Proof. unfold Q2R; simpl; lra. Qed.
Ltac in_limit := split; [assumption |]; unfold within_limits; cbn -[Q2R]; rewrite limit_is; repeat split;
  rewrite Rabs_pos_eq; lra.
Ltac plain_lost L := replace (Q2R lost) with few in L by (unfold Q2R, lost; simpl; lra).

(* ---- The next lines ---- *)
Section Crossing.
Hypotheses (share_low_in : 0 <= x share_low <= 1) (share_high_in : 0 <= x share_high <= 1).
Hypotheses (shares : x share_low + x share_high = 1) (climb_in : 0 <= x climb <= C).
Definition real_ground := x share_low * x low + x share_high * x high - x climb.
Lemma ground_near g : computes32 x ground g -> Rabs (g - real_ground) <= 501 / 100 * u * (H + C) + few.
Proof.
  intros Cg. assert (L : limited32 2147483648 x ground g) by in_limit.
  near_in 2147483648%Q lost ground L. plain_lost L. cbn -[u32 alpha] in L.
  rewrite !(Rabs_pos_eq (x _)) in L by lra. assert (A := alpha_below 5 ltac:(lia)). simpl INR in A.
  assert (P1 := Rmult_le_compat_r (x share_low) _ _ ltac:(lra) (proj2 low_in)).
  assert (P2 := Rmult_le_compat_r (x share_high) _ _ ltac:(lra) (proj2 high_in)).
  assert (Q1 := Rmult_le_pos (x low) (x share_low) ltac:(lra) ltac:(lra)).
  assert (Q2 := Rmult_le_pos (x high) (x share_high) ltac:(lra) ltac:(lra)).
  assert (S : H * x share_low + H * x share_high = H) by (rewrite <- Rmult_plus_distr_l, shares; ring).
  match type of L with _ <= _ * ?p + _ => assert (P0 : 0 <= p <= H + C) by lra; assert (E := Rmult_le_compat _ _ _ _
    (alpha_at_least 5) (proj1 P0) A (proj2 P0)) end.
  unfold real_ground. apply between in L. apply Rabs_le. lra.
Qed.

Definition least_of_sizes : Q := 71 # 167772160.
Hypothesis margin_in : Q2R least_of_sizes * (H + C) + 35 / 10 * few <= x near_margin <= 2147483648.
Lemma margin_least : 705 / 100 * u * (H + C) + 35 / 10 * few <= x near_margin.
Proof.
  replace (Q2R least_of_sizes) with (71 / 10 * u) in margin_in by (unfold Q2R, least_of_sizes; simpl; lra). lra.
Qed.

(* From what is computed on a side of the height, to what is real there. *)
Ltac is_certain side computed_ground computed_side :=
  let M := fresh in let M0 := fresh in let L := fresh in let A := fresh in let E := fresh in
  apply ground_near in computed_ground; assert (M := margin_least);
  assert (M0 : 0 <= x near_margin) by lra;
  match type of computed_side with computes32 x side ?value =>
    assert (L : limited32 2147483648 x side value) by in_limit
  end;
  near_in 2147483648%Q lost side L; plain_lost L;
  cbn -[u32 alpha] in L; rewrite !(Rabs_pos_eq (x _)) in L by lra;
  assert (A := alpha_below 2 ltac:(lia)); simpl INR in A;
  assert (E := Rmult_le_compat_r (x height + x near_margin) _ _ ltac:(lra) A);
  apply between in computed_ground; apply between in L; lra.
Theorem lit_is_above g b : computes32 x ground g -> computes32 x below b -> g < b -> real_ground < x height.
Proof. intros Cg Cb less. is_certain below Cg Cb. Qed.
Theorem dark_is_below g a : computes32 x ground g -> computes32 x above a -> a < g -> x height < real_ground.
Proof. intros Cg Ca more. is_certain above Cg Ca. Qed.
End Crossing.

(* ---- A ray that is walked alone ---- *)
Section Walked.
Hypotheses (share_in : 0 <= x share <= 1) (climb_in : 0 <= x climb <= 1073741824) (farther_in : 0 <= x farther <= 65536).
Hypothesis climbed : x climb * x farther <= C.
Definition real_walked := x low + x share * (x high - x low) - x climb * x farther.
Theorem walked_near w : computes32 x walked w -> Rabs (w - real_walked) <= 2401 / 100 * u * H + 801 / 100 * u * C + few.
Proof.
  intros Cw. assert (L : limited32 2147483648 x walked w) by in_limit.
  near_in 2147483648%Q lost walked L. plain_lost L. cbn -[u32 alpha] in L.
  rewrite !(Rabs_pos_eq (x _)) in L by lra. assert (A := alpha_below 8 ltac:(lia)). simpl INR in A.
  assert (P1 := Rmult_le_compat _ 1 (x high + x low) (H + H) (proj1 share_in) ltac:(lra) (proj2 share_in)
    (Rplus_le_compat _ _ _ _ (proj2 high_in) (proj2 low_in))).
  assert (Q1 := Rmult_le_pos (x share) (x high + x low) ltac:(lra) ltac:(lra)).
  assert (Q2 := Rmult_le_pos (x climb) (x farther) ltac:(lra) ltac:(lra)).
  match type of L with _ <= alpha u32 ?k * ?p + _ => assert (P0 : 0 <= p <= 3 * H + C) by lra;
    assert (G : alpha u32 k <= alpha u32 8) by (apply alpha_grows; [apply bpow_ge_0 | lia]);
    assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least k) (proj1 P0) (Rle_trans _ _ _ G A) (proj2 P0)) end.
  unfold real_walked. apply between in L. apply Rabs_le. lra.
Qed.
End Walked.
End Ray.

(* ---- Between two lines ---- *)
(* Along a ray, t from 0 on one line to 1 on the next, the ground is straight but for kinks: at p its slope falls by b. *)
Definition kinks := list (R * R).
Fixpoint of_kinks (l : kinks) t : R := match l with nil => 0 | ((p, b) :: l)%list => b * Rmax (t - p) 0 + of_kinks l t end.
Definition bent a c l t := a + c * t - of_kinks l t.
Fixpoint all_bends (l : kinks) : R := match l with nil => 0 | ((p, b) :: l)%list => Rmax 0 b / 4 + all_bends l end.
Theorem bent_is_below a c l t : List.Forall (fun k => 0 <= fst k <= 1) l -> 0 <= t <= 1 ->
  bent a c l t <= (1 - t) * bent a c l 0 + t * bent a c l 1 + all_bends l.
Proof.
  intros P T. unfold bent.
  enough (E : (1 - t) * of_kinks l 0 + t * of_kinks l 1 <= of_kinks l t + all_bends l) by lra.
  induction P as [| [p b] l Hp P IH]; cbn [of_kinks all_bends fst] in *; [lra |].
  rewrite (Rmax_right (0 - p) 0), (Rmax_left (1 - p) 0) by lra.
  assert (K : t * (1 - p) - Rmax (t - p) 0 <= / 4 /\ 0 <= t * (1 - p) - Rmax (t - p) 0).
  { assert (square : 0 <= (p - / 2) * (p - / 2)) by (apply Rle_0_sqr).
    assert (tp := Rmult_le_compat_r (1 - p) t 1 ltac:(lra) (proj2 T)).
    destruct (Rle_dec t p) as [L | G].
    - rewrite Rmax_right by lra. assert (A := Rmult_le_compat_r (1 - p) t p ltac:(lra) L).
      assert (B := Rmult_le_pos t (1 - p) ltac:(lra) ltac:(lra)). lra.
    - rewrite Rmax_left by lra. assert (A := Rmult_le_compat_l p _ _ (proj1 Hp) (Rlt_le _ _ (Rnot_le_lt _ _ G))).
      assert (B := Rmult_le_compat_l p t 1 (proj1 Hp) (proj2 T)). lra. }
  set (k := t * (1 - p) - Rmax (t - p) 0) in *. destruct (Rle_dec 0 b) as [b0 | b0].
  - rewrite (Rmax_right 0 b) by lra. assert (A := Rmult_le_compat_l b _ _ b0 (proj1 K)). unfold k in *. lra.
  - rewrite (Rmax_left 0 b) by lra. assert (A := Rmult_le_pos (- b) k ltac:(lra) (proj2 K)). unfold k in *. lra.
Qed.
(* Two straight lines that meet at p. *)
Lemma kink a c a' c' p t : a + c * p = a' + c' * p -> a' + c' * t = a + c * t - (c - c') * (t - p).
Proof. intros E. assert (F : a' = a + c * p - c' * p) by lra. rewrite F. ring. Qed.
(* A ray goes `side` rows to the side, from a place between rows 0 and 1 of this line (h) to the next (n). Of a rising diagonal
   it leaves h0 h1 n1, over the diagonal to h0 n0 n1 or over row 1 to h1 n1 n2; of a falling one it leaves h0 h1 n0 over the
   diagonal, and h1 n0 n1 over row 1 to h1 h2 n1. Both planes agree on the edge; along the ray the slope falls by: *)
Definition over_plane z along_line along_row t r : R := z + along_line * t + along_row * r.
Definition slope_of along_line along_row side : R := along_line + side * along_row.
Lemma along_the_ray z a b t r side : over_plane z a b t (r + side * t) = z + b * r + slope_of a b side * t.
Proof. unfold over_plane, slope_of. ring. Qed.
Theorem rising_bends h0 h1 n0 n1 n2 side t :
  over_plane h0 (n1 - h1) (h1 - h0) t t = over_plane h0 (n0 - h0) (n1 - n0) t t /\
  over_plane h0 (n1 - h1) (h1 - h0) t 1 = over_plane (h1 - (n2 - n1)) (n1 - h1) (n2 - n1) t 1 /\
  slope_of (n1 - h1) (h1 - h0) side - slope_of (n0 - h0) (n1 - n0) side = (1 - side) * ((h0 - n0) + (n1 - h1)) /\
  slope_of (n1 - h1) (h1 - h0) side - slope_of (n1 - h1) (n2 - n1) side = side * ((h1 - h0) - (n2 - n1)).
Proof. unfold over_plane, slope_of. repeat split; ring. Qed.
Theorem falling_bends h0 h1 h2 n0 n1 side t :
  over_plane h0 (n0 - h0) (h1 - h0) t (1 - t) = over_plane (h1 - (n1 - n0)) (n1 - h1) (n1 - n0) t (1 - t) /\
  over_plane (h1 - (n1 - n0)) (n1 - h1) (n1 - n0) t 1 = over_plane (h1 - (h2 - h1)) (n1 - h1) (h2 - h1) t 1 /\
  slope_of (n0 - h0) (h1 - h0) side - slope_of (n1 - h1) (n1 - n0) side = (-1 - side) * ((h0 - n0) + (n1 - h1)) /\
  slope_of (n1 - h1) (n1 - n0) side - slope_of (n1 - h1) (h2 - h1) side = side * ((n1 - n0) - (h2 - h1)).
Proof. unfold over_plane, slope_of. repeat split; ring. Qed.
(* A line across a strip, from 0 to 1, is straight but for a vertex at p, v high: `over` is what that is above the straight
   line. Raised at both ends by its positive part it is nowhere below the ground, lowered by its negative part nowhere above. *)
Theorem across_a_strip e0 e1 v p t : 0 < p < 1 -> 0 <= t <= 1 ->
  let over := v - (e0 + p * (e1 - e0)) in let straight := e0 + t * (e1 - e0) in
  let ground := if Rle_dec t p then e0 + t / p * (v - e0) else e1 + (1 - t) / (1 - p) * (v - e1) in
  straight + Rmin over 0 <= ground <= straight + Rmax over 0.
Proof.
  intros P T over straight ground.
  assert (G : exists k, 0 <= k <= 1 /\ ground = straight + k * over).
  { unfold ground, straight, over. destruct (Rle_dec t p) as [L | G].
    - exists (t / p). split; [| field; lra]. assert (I := Rinv_0_lt_compat p ltac:(lra)). unfold Rdiv. split.
      + apply Rmult_le_pos; lra.
      + apply Rmult_le_reg_r with p; [lra |]. rewrite Rmult_assoc, Rinv_l by lra. lra.
    - exists ((1 - t) / (1 - p)). split; [| field; lra]. assert (I := Rinv_0_lt_compat (1 - p) ltac:(lra)). unfold Rdiv. split.
      + apply Rmult_le_pos; lra.
      + apply Rmult_le_reg_r with (1 - p); [lra |]. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  destruct G as (k & K & ->). destruct (Rle_dec 0 over) as [o | o].
  - rewrite (Rmin_right over 0), (Rmax_left over 0) by lra. assert (A := Rmult_le_compat_r over _ _ o (proj2 K)).
    assert (B := Rmult_le_pos _ _ (proj1 K) o). lra.
  - rewrite (Rmin_left over 0), (Rmax_right over 0) by lra. assert (A := Rmult_le_compat_r (- over) _ _ ltac:(lra) (proj2 K)).
    assert (B := Rmult_le_pos k (- over) (proj1 K) ltac:(lra)). lra.
Qed.
(* The greater of straight lines is nowhere above the straight line between the greatest at both ends. *)
Lemma greatest_at_ends a b c d t : 0 <= t <= 1 ->
  Rmax (a + t * (b - a)) (c + t * (d - c)) <= Rmax a c + t * (Rmax b d - Rmax a c).
Proof.
  intros T. assert (A := Rmax_l a c). assert (B := Rmax_r a c). assert (C := Rmax_l b d). assert (D := Rmax_r b d).
  assert (A' := Rmult_le_compat_l (1 - t) _ _ ltac:(lra) A). assert (B' := Rmult_le_compat_l (1 - t) _ _ ltac:(lra) B).
  assert (C' := Rmult_le_compat_l t _ _ (proj1 T) C). assert (D' := Rmult_le_compat_l t _ _ (proj1 T) D).
  apply Rmax_lub; lra.
Qed.

(* The kernel's bends: a quarter of each, rounded. Three that are positive, or 0, are added. *)
Section Bends.
Variable x : nat -> R.
Variable H : R.
Hypotheses (H_in : 0 <= H <= 2097152) (slope_in : 0 <= x slope <= 1).
Let height i := 0 <= x i <= H.
Hypotheses (h_x_in : height h_x) (h_y_in : height h_y) (h_z_in : height h_z) (h_w_in : height h_w).
Hypotheses (n_x_in : height n_x) (n_y_in : height n_y) (n_z_in : height n_z) (n_w_in : height n_w).
Definition a_quarter e b := 4 * real x e = b.
Theorem kernels_bends :
  a_quarter greater_1_other ((1 - x slope) * ((x h_x - x n_x) + (x n_y - x h_y))) /\
  a_quarter greater_2_other ((1 - x slope) * ((x h_y - x n_y) + (x n_z - x h_z))) /\
  a_quarter greater_4_other ((1 - x slope) * ((x h_z - x n_z) + (x n_w - x h_w))) /\
  a_quarter greater_3_other (x slope * ((x h_y - x h_x) - (x n_z - x n_y))) /\
  a_quarter greater_5_other (x slope * ((x h_z - x h_y) - (x n_w - x n_z))) /\
  a_quarter greater_7_other ((-1 - x slope) * ((x h_x - x n_x) + (x n_y - x h_y))) /\
  a_quarter greater_8_other ((-1 - x slope) * ((x h_y - x n_y) + (x n_z - x h_z))) /\
  a_quarter greater_10_other ((-1 - x slope) * ((x h_z - x n_z) + (x n_w - x h_w))) /\
  a_quarter greater_9_other (x slope * ((x n_y - x n_x) - (x h_z - x h_y))) /\
  a_quarter greater_11_other (x slope * ((x n_z - x n_y) - (x h_w - x h_z))).
Proof.
  unfold a_quarter. repeat split; cbn -[Q2R]; rewrite ?Q2R_1, ?Q2R_0'; replace (Q2R (1 # 4)) with (/ 4) by (unfold Q2R; simpl; lra);
    try replace (Q2R (-1 # 1)) with (-1) by (unfold Q2R; simpl; lra); field.
Qed.
Definition kernels_bend e := List.In e (greater_1_other :: greater_2_other :: greater_3_other :: greater_4_other ::
  greater_5_other :: greater_7_other :: greater_8_other :: greater_9_other :: greater_10_other :: greater_11_other :: nil)%list.
Theorem bend_near e v : kernels_bend e -> computes32 x e v ->
  Rabs (v - real x e) <= 601 / 100 * u * H + few /\ Rabs (real x e) <= H.
Proof.
  intros I C. assert (L : limited32 2147483648 x e v).
  { split; [exact C |]. unfold within_limits. destruct I as [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | []]]]]]]]]]];
      cbn -[Q2R]; rewrite limit_is; unfold height in *; repeat split; apply Rabs_le; lra. }
  assert (T : Qle_bool (takes 2147483648 e) lost = true)
    by (destruct I as [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | []]]]]]]]]]]; vm_compute; reflexivity).
  apply (near_limited 2147483648 lost x e v T) in L. replace (Q2R lost) with few in L by (unfold Q2R, lost; simpl; lra).
  assert (A := alpha_below 6 ltac:(lia)). simpl INR in A.
  assert (R6 : (roundings e <= 6)%nat)
    by (destruct I as [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | []]]]]]]]]]]; vm_compute; lia).
  assert (G := alpha_grows u32 (bpow_ge_0 _ _) _ _ R6). assert (Z := alpha_at_least (roundings e)).
  assert (P : permanent x e <= H /\ 0 <= permanent x e).
  { split; [| apply permanent_positive].
    assert (apart : forall i j, height i -> height j -> 0 <= Rabs (x i - x j) <= H)
      by (unfold height; intros; split; [apply Rabs_pos | apply Rabs_le; lra]).
    assert (two : forall i j k l, height i -> height j -> height k -> height l -> forall w, 0 <= w <= / 2 ->
      (Rabs (x i - x j) + Rabs (x k - x l)) * w <= H).
    { intros i j k l Hi Hj Hk Hl w Hw. assert (A1 := apart i j Hi Hj). assert (A2 := apart k l Hk Hl).
      assert (K := Rmult_le_compat (Rabs (x i - x j) + Rabs (x k - x l)) (H + H) w (/ 2) ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)).
      lra. }
    destruct I as [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | []]]]]]]]]]]; cbn -[Q2R];
      rewrite ?Q2R_1; replace (Q2R (1 # 4)) with (/ 4) by (unfold Q2R; simpl; lra);
      try replace (Q2R (-1 # 1)) with (-1) by (unfold Q2R; simpl; lra);
      rewrite ?(Rabs_pos_eq (/ 4)), ?(Rabs_pos_eq (x slope)), ?(Rabs_pos_eq 1), ?(Rabs_left (-1)) by lra;
      first [apply two; assumption || lra | rewrite Rmult_comm; apply two; assumption || lra]. }
  split.
  - assert (E := Rmult_le_compat _ _ _ _ Z (proj2 P) (Rle_trans _ _ _ G A) (proj1 P)). lra.
  - eapply Rle_trans; [apply real_below_permanent | apply P].
Qed.
(* The sum of three, as a row and two diagonals: x i, x j and x k are what is computed, b_i and so on are real quarters. *)
Theorem sum_of_bends i j k b_i b_j b_k v : let off g b := 0 <= x g /\ Rmax 0 b <= x g + (601 / 100 * u * H + few) /\ x g <= 2 * H + 1 in
  off i b_i -> off j b_j -> off k b_k ->
  computes32 x (Add (Add (Given i 0) (Given j 0)) (Given k 0)) v ->
  Rmax 0 b_i + Rmax 0 b_j + Rmax 0 b_k <= v + 34 * u * H + / 1000000.
Proof.
  intros off (i0 & i1 & i2) (j0 & j1 & j2) (k0 & k1 & k2) C. assert (l := h32_below). simpl in l.
  destruct (step32_add _ _ _ _ C) as (p & q & Cp & Cq & R). apply given32_is in Cq. subst q.
  destruct (step32_add _ _ _ _ Cp) as (a & b & Ca & Cb & S). apply given32_is in Ca, Cb. subst a b.
  rewrite (Rabs_pos_eq (x i + x j)) in S by lra. apply between in S. assert (p0 : Rabs (p + x k) <= 7 * H + 4) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ R) in p0. apply between in p0. lra.
Qed.
End Bends.
Lemma kernel_is_enough : (least_of_sizes <= value_of of_sizes /\ (35 # 10) * lost <= (99 # 100) * value_of of_nothing)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_of_sizes (value_of of_sizes).
Print constants.
Definition checked := (lit_is_above, dark_is_below, walked_near, bent_is_below, kink, along_the_ray, rising_bends, falling_bends,
  across_a_strip, greatest_at_ends, kernels_bends, bend_near, sum_of_bends, kernel_is_enough).
Print Assumptions checked.
