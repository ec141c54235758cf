(* SPDX-License-Identifier: MIT *)
(* sweeps.cl: the ground where a vertex's own ray meets edges, against the vertex's height less or plus a margin; and what bounds
   the ground across a strip and between two lines (docs/numerics.md, 16).
     lit_is_above, dark_is_below   of the next lines, with near_margin: the real ground is below, or above, the ray;
     walked_near                   along the whole ray, walked alone: 24 u of the greatest height and 8 u of the climb;
     across_a_strip, greatest_at_ends   a line raised or lowered at both ends; the greatest of straight lines;
     rising_bends, falling_bends, kernels_bends, bent_is_below   where a ray crosses a diagonal or a row, how much its slope falls,
                                   and that the ground is above the straight line by a quarter of that at most;
     bend_near, sum_of_bends       the same as computed: 34 u H of three;
     most_near, least_near, kept_is, line_is_kept   a line across a strip and what is kept of it, as computed: 61 u H + 4.2 u C;
     strip_is_below, strip_is_above        all ground of a strip is below, or some above, a ray: 93 u H + 15 u C.

   Assumed: heights are 0 to H, up to 2^21, each off by one rounding (RasterCopies subtracts the lowest), a ray's climb C is
   up to 2^31 in all; the host rounds shares of an edge and the climb up to it once (set_crossings()); along a ray that is
   walked a share is rounded once and a distance twice; the margin is SWEEP_CROSSING_ERROR (H + C) + SWEEP_LOST at least
   (set_margins() has 1.01 of the first in double, and rounds the sum once), up to 2^31. Denormals may be kept or flushed. Between two lines
   heights are the floats that are kept. What is kept at both sides is within 5 H + C of 0 and of each other; a
   ray's place on a line is rounded once. In prose: walked_near has room in the margin, 128 u H + 24 u C; that a ray crosses at
   most one row and two diagonals between two lines; unevenness; what lit and dark mean. *)
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
Definition rest := 18%nat.
Definition lines := 19%nat.
Definition bound_x := 20%nat.
Definition bound_y := 21%nat.
Definition before_low := 22%nat.
Definition before_high := 23%nat.
Definition last_low := 24%nat.
Definition last_high := 25%nat.
Definition light_5 := 26%nat.
Definition copy_1 := 27%nat.
Definition copy_2 := 28%nat.
Definition copy_3 := 29%nat.
Definition copy_4 := 30%nat.
Definition copy_5 := 31%nat.
Definition copy_6 := 32%nat.
Definition copy_7 := 33%nat.
Definition copy_8 := 34%nat.
Definition light_17 := 35%nat.
Definition greater_1 := 36%nat.
Definition greater_2 := 37%nat.
Definition greater_3 := 38%nat.
Definition greater_4 := 39%nat.
Definition greater_5 := 40%nat.
Definition greater_6 := 41%nat.
Definition greater_7 := 42%nat.
Definition greater_8 := 43%nat.
Definition greater_9 := 44%nat.
Definition greater_10 := 45%nat.
Definition greater_11 := 46%nat.
Definition greater_12 := 47%nat.
Definition greater_13 := 48%nat.
Definition lesser_1 := 49%nat.
Definition greater_14 := 50%nat.
Definition greater_15 := 51%nat.
Definition greater_16 := 52%nat.
Definition greater_17 := 53%nat.
Definition greater_18 := 54%nat.
Definition greater_19 := 55%nat.
Definition greater_20 := 56%nat.
Definition greater_21 := 57%nat.
Definition greater_22 := 58%nat.
Definition greater_23 := 59%nat.
Definition greater_24 := 60%nat.
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
  Const (1 # 151115727451828646838272).
Definition of_heights :=
  Const (128 # 1).
Definition of_climb :=
  Const (24 # 1).
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
Definition greater_13_one :=
  greater_11_one.
Definition greater_13_other :=
  Sub (Given h_y 0) (Add (Add (Given h_x 0) (Mul (Given rest 1) (Diff h_y h_x))) (Mul (Sub (Add (Given h_y 0) (Mul
    (Given rest 1) (Diff h_z h_y))) (Add (Given h_x 0) (Mul (Given rest 1) (Diff h_y h_x)))) (Sub (Const (1 # 1))
    (Given rest 1)))).
Definition most_low :=
  Sub (Add (Add (Given h_x 0) (Mul (Given rest 1) (Diff h_y h_x))) (Given greater_13 0)) (Mul (Given climb 1) (Given
    lines 0)).
Definition most_high :=
  Sub (Add (Add (Given h_y 0) (Mul (Given rest 1) (Diff h_z h_y))) (Given greater_13 0)) (Mul (Given climb 1) (Given
    lines 0)).
Definition lesser_1_one :=
  greater_13_one.
Definition lesser_1_other :=
  greater_13_other.
Definition least_low :=
  Sub (Add (Add (Given h_x 0) (Mul (Given rest 1) (Diff h_y h_x))) (Given lesser_1 0)) (Mul (Given climb 1) (Given
    lines 0)).
Definition least_high :=
  Sub (Add (Add (Given h_y 0) (Mul (Given rest 1) (Diff h_z h_y))) (Given lesser_1 0)) (Mul (Given climb 1) (Given
    lines 0)).
Definition across :=
  Add (Given bound_x 0) (Mul (Sub (Const (1 # 1)) (Given rest 1)) (Diff bound_y bound_x)).
Definition ray :=
  Sub (Given height 1) (Mul (Given climb 1) (Given lines 0)).
Definition greater_14_one :=
  lesser_1_one.
Definition greater_14_other :=
  Mul (Add (Diff copy_1 copy_5) (Diff copy_6 copy_2)) (Times (1 # 4) (Sub (Const (1 # 1)) (Given light_17 0))).
Definition greater_15_one :=
  greater_14_one.
Definition greater_15_other :=
  Mul (Add (Diff copy_2 copy_6) (Diff copy_7 copy_3)) (Times (1 # 4) (Sub (Const (1 # 1)) (Given light_17 0))).
Definition greater_16_one :=
  greater_15_one.
Definition greater_16_other :=
  Mul (Times (1 # 4) (Given light_17 0)) (Sub (Diff copy_2 copy_1) (Diff copy_7 copy_6)).
Definition greater_17_one :=
  greater_16_one.
Definition greater_17_other :=
  Mul (Add (Diff copy_3 copy_7) (Diff copy_8 copy_4)) (Times (1 # 4) (Sub (Const (1 # 1)) (Given light_17 0))).
Definition greater_18_one :=
  greater_17_one.
Definition greater_18_other :=
  Mul (Times (1 # 4) (Given light_17 0)) (Sub (Diff copy_3 copy_2) (Diff copy_8 copy_7)).
Definition greater_19_one :=
  Add (Add (Given greater_14 0) (Given greater_15 0)) (Given greater_16 0).
Definition greater_19_other :=
  Add (Add (Given greater_15 0) (Given greater_17 0)) (Given greater_18 0).
Definition greater_20_one :=
  greater_18_one.
Definition greater_20_other :=
  Sub (Given copy_2 0) (Add (Add (Given copy_1 0) (Times (0 # 1) (Diff copy_2 copy_1))) (Sub (Add (Given copy_2 0)
    (Times (0 # 1) (Diff copy_3 copy_2))) (Add (Given copy_1 0) (Times (0 # 1) (Diff copy_2 copy_1))))).
Definition greater_21_one := Given last_low 0.
Definition greater_21_other :=
  Sub (Add (Add (Given copy_1 0) (Times (0 # 1) (Diff copy_2 copy_1))) (Given greater_20 0)) (Times (0 # 1) (Given
    light_5 0)).
Definition greater_22_one :=
  Add (Given greater_19 0) (Given greater_21 0).
Definition greater_22_other := Given before_low 0.
Definition kept_low := Given greater_22 0.
Definition greater_23_one := Given last_high 0.
Definition greater_23_other :=
  Sub (Add (Add (Given copy_2 0) (Times (0 # 1) (Diff copy_3 copy_2))) (Given greater_20 0)) (Times (0 # 1) (Given
    light_5 0)).
Definition greater_24_one :=
  Add (Given greater_19 0) (Given greater_23 0).
Definition greater_24_other := Given before_high 0.
Definition kept_high := Given greater_24 0.
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
Theorem sum_of_bends i j k b_i b_j b_k v : let off g b := 0 <= x g /\ Rmax 0 b <= x g + (601 / 100 * u * H + few) /\ x g <= 2 * H + few in
  off i b_i -> off j b_j -> off k b_k ->
  computes32 x (Add (Add (Given i 0) (Given j 0)) (Given k 0)) v ->
  Rmax 0 b_i + Rmax 0 b_j + Rmax 0 b_k <= v + 34 * u * H + 4 * few.
Proof.
  intros off (i0 & i1 & i2) (j0 & j1 & j2) (k0 & k1 & k2) C. assert (l := h32_below). simpl in l.
  destruct (step32_add _ _ _ _ C) as (p & q & Cp & Cq & R). apply given32_is in Cq. subst q.
  destruct (step32_add _ _ _ _ Cp) as (a & b & Ca & Cb & S). apply given32_is in Ca, Cb. subst a b.
  rewrite (Rabs_pos_eq (x i + x j)) in S by lra. apply between in S. assert (p0 : Rabs (p + x k) <= 7 * H + 4 * few) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ R) in p0. apply between in p0. lra.
Qed.
End Bends.

(* ---- Bounds across a strip, as computed ---- *)
Section Strip.
Variable x : nat -> R.
Variables H C : R.
Hypotheses (H_in : 0 <= H <= 2097152) (C_in : 0 <= C <= 2147483648).
Let high i := 0 <= x i <= H.
Hypotheses (h_x_in : high h_x) (h_y_in : high h_y) (h_z_in : high h_z) (height_in : high height).
Hypotheses (rest_in : 0 <= x rest <= 1).
Hypotheses (climb_in : 0 <= x climb <= 1073741824) (lines_in : 0 <= x lines <= 65536) (climbed : x climb * x lines <= C).
Let plane := x climb * x lines.
Lemma given_near i k v : (k <= 16)%nat -> 0 <= x i -> computes32 x (Given i k) v -> Rabs (v - x i) <= INR k * (1001 / 1000) * u * x i.
Proof.
  intros K P D. apply near32 in D. replace (lost32 x (Given i k)) with 0 in D by reflexivity.
  change (roundings (Given i k)) with k in D. change (real x (Given i k)) with (x i) in D.
  change (permanent x (Given i k)) with (Rabs (x i)) in D. rewrite (Rabs_pos_eq (x i)) in D by exact P.
  assert (A := alpha_below k K). assert (k0 := pos_INR k). assert (A2 : alpha u32 k <= INR k * (1001 / 1000) * u) by
    (assert (0 <= INR k * u) by (apply Rmult_le_pos; lra); lra).
  assert (G := Rmult_le_compat_r _ _ _ P A2). lra.
Qed.
Definition end_of i j := Add (Given i 0) (Mul (Given rest 1) (Diff j i)).
Let real_end i j := x i + x rest * (x j - x i).
Lemma end_near i j v : high i -> high j -> computes32 x (end_of i j) v ->
  Rabs (v - real_end i j) <= 403 / 100 * u * H + few /\ 0 <= real_end i j <= H.
Proof.
  intros Hi Hj D. unfold high, real_end in *. assert (l := h32_below). assert (l0 := h32_positive). simpl in l.
  destruct (step32_add _ _ _ _ D) as (a & m & Da & Dm & R). apply given32_is in Da. subst a.
  destruct (step32_mul _ _ _ _ Dm) as (r & d & Dr & Dd & S). apply given_near in Dr; [| lia | lra]. simpl INR in Dr.
  apply step32_diff in Dd. assert (D0 : Rabs (x j - x i) <= H) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ Dd) in D0 as Dd'.
  assert (r1 : Rabs (r - x rest) <= 1001 / 1000 * u) by lra. clear Dr. assert (r2 := between _ _ r1). assert (d2 := between _ _ Dd').
  assert (d3 : Rabs d <= (1 + 2 * u) * H + 4 * h32) by (apply between in D0; apply Rabs_le; lra).
  assert (p1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) r1 d3). rewrite <- Rabs_mult in p1.
  assert (p2 : Rabs (x rest * (d - (x j - x i))) <= 1 * (u * H + 4 * h32)).
  { rewrite Rabs_mult, (Rabs_pos_eq (x rest)) by lra. apply Rmult_le_compat; try lra; apply Rabs_pos. }
  assert (r3 : Rabs r <= 1 + 2 * u) by (apply Rabs_le; lra).
  assert (p3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) r3 d3). rewrite <- Rabs_mult in p3.
  assert (hd : h32 * (Rabs r + Rabs d + 1) <= h32 * 3000000) by (apply Rmult_le_compat_l; lra).
  apply (at_most32 _ _ _ _ S) in p3. apply between in p1, p2, p3.
  assert (mean : 0 <= x i + x rest * (x j - x i) <= H).
  { assert (A := Rmult_le_compat_l (1 - x rest) _ _ ltac:(lra) (proj2 Hi)). assert (B := Rmult_le_compat_l (x rest) _ _ ltac:(lra) (proj2 Hj)).
    assert (A' := Rmult_le_pos (1 - x rest) (x i) ltac:(lra) ltac:(lra)). assert (B' := Rmult_le_pos (x rest) (x j) ltac:(lra) ltac:(lra)). lra. }
  assert (m1 : Rabs (m - x rest * (x j - x i)) <= 302 / 100 * u * H + few / 2) by (apply Rabs_le; lra).
  apply between in m1. assert (s1 : Rabs (x i + m) <= (1 + 4 * u) * H + 1) by (apply Rabs_le; lra).
  split; [| exact mean].
  assert (s2 : Rabs (x i + m) <= (1 + 4 * u) * H + few) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ R) in s2.
  apply between in s2. apply Rabs_le. lra.
Qed.
(* The ends, as they are computed: the same floats wherever they are used. *)
Definition e0 := 97%nat.
Definition e1 := 98%nat.
Hypotheses (e0_is : computes32 x (end_of h_x h_y) (x e0)) (e1_is : computes32 x (end_of h_y h_z) (x e1)).
Definition over_of a b := Sub (Given h_y 0) (Add a (Mul (Sub b a) (Sub (Const (1 # 1)) (Given rest 1)))).
Lemma over_is : greater_13_other = over_of (end_of h_x h_y) (end_of h_y h_z) /\ lesser_1_other = greater_13_other.
Proof. split; reflexivity. Qed.
Let E0 := real_end h_x h_y. Let E1 := real_end h_y h_z.
Let over := x h_y - (E0 + (1 - x rest) * (E1 - E0)).
Theorem over_near v : computes32 x (over_of (Given e0 0) (Given e1 0)) v -> Rabs (v - over) <= 111 / 10 * u * H + 3 * few.
Proof.
  intros D. destruct (end_near _ _ _ h_x_in h_y_in e0_is) as [N0 I0]. destruct (end_near _ _ _ h_y_in h_z_in e1_is) as [N1 I1].
  fold E0 in N0, I0. fold E1 in N1, I1. unfold high in *. assert (l := h32_below). assert (l0 := h32_positive). simpl in l.
  destruct (step32_sub _ _ _ _ D) as (a & b & Da & Db & R). apply given32_is in Da. subst a.
  destruct (step32_add _ _ _ _ Db) as (a & m & Da & Dm & S). apply given32_is in Da. subst a.
  destruct (step32_mul _ _ _ _ Dm) as (d & s & Dd & Ds & T).
  destruct (step32_sub _ _ _ _ Dd) as (p & q & Dp & Dq & U). apply given32_is in Dp, Dq. subst p q.
  destruct (step32_sub _ _ _ _ Ds) as (p & q & Dp & Dq & V). apply const32_is in Dp. rewrite Q2R_1 in Dp. subst p.
  apply given_near in Dq; [| lia | lra]. simpl INR in Dq. assert (q1 : Rabs (q - x rest) <= 1001 / 1000 * u) by lra. clear Dq.
  apply between in N0, N1, q1. assert (v1 : Rabs (1 - q) <= 1 + 2 * u) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ V) in v1.
  apply between in v1. assert (s1 : Rabs (s - (1 - x rest)) <= 202 / 100 * u) by (apply Rabs_le; lra).
  assert (u1 : Rabs (x e1 - x e0) <= (1 + 9 * u) * H + 2 * few) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ U) in u1 as u2.
  set (F := x e1 - x e0) in *. assert (F_in := between _ _ u1). apply between in u2.
  assert (d1 : Rabs d <= (1 + 11 * u) * H + 3 * few) by (apply Rabs_le; lra).
  assert (s2 : Rabs s <= 1 + 3 * u) by (apply between in s1; apply Rabs_le; lra).
  assert (p1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) d1 s1). rewrite <- Rabs_mult in p1.
  assert (p2 : Rabs ((d - F) * (1 - x rest)) <= (101 / 100 * u * H + few) * 1).
  { rewrite Rabs_mult, (Rabs_pos_eq (1 - x rest)) by lra. apply Rmult_le_compat; first [lra | apply Rabs_pos | apply Rabs_le; lra]. }
  assert (p3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) d1 s2). rewrite <- Rabs_mult in p3.
  assert (hd : h32 * (Rabs d + Rabs s + 1) <= h32 * 3000000) by (apply Rmult_le_compat_l; lra).
  apply (at_most32 _ _ _ _ T) in p3. apply between in p1, p2, p3.
  assert (m1 : Rabs (m - F * (1 - x rest)) <= 406 / 100 * u * H + 3 / 2 * few) by (apply Rabs_le; lra).
  (* The mean of the ends, of which each is off as much. *)
  assert (mean : forall a b w, - w <= a <= w -> - w <= b <= w -> - w <= (1 - x rest) * a + x rest * b <= w).
  { intros a' b' w A B. assert (A1 := Rmult_le_compat_l (1 - x rest) _ _ ltac:(lra) (proj2 A)).
    assert (A2 := Rmult_le_compat_l (1 - x rest) _ _ ltac:(lra) (proj1 A)).
    assert (B1 := Rmult_le_compat_l (x rest) _ _ ltac:(lra) (proj2 B)). assert (B2 := Rmult_le_compat_l (x rest) _ _ ltac:(lra) (proj1 B)). lra. }
  assert (off := mean (x e1 - E1) (x e0 - E0) (403 / 100 * u * H + few) ltac:(lra) ltac:(lra)).
  assert (at_vertex := mean (E1 - H / 2) (E0 - H / 2) (H / 2) ltac:(lra) ltac:(lra)).
  apply between in m1. assert (w1 : Rabs (x e0 + m) <= (1 + 9 * u) * H + 3 * few) by (unfold F in *; apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ S) in w1. apply between in w1.
  assert (b1 : Rabs (x h_y - b) <= (1 + 11 * u) * H + 4 * few) by (unfold F in *; apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ R) in b1. apply between in b1. unfold over, F in *. apply Rabs_le. lra.
Qed.
(* A side of the line, raised by `up` or lowered by `down`, over the plane. *)
Definition over_plane_of e g := Sub (Add (Given e 0) (Given g 0)) (Mul (Given climb 1) (Given lines 0)).
Lemma sides_are : most_low = Sub (Add (end_of h_x h_y) (Given greater_13 0)) (Mul (Given climb 1) (Given lines 0)) /\
  most_high = Sub (Add (end_of h_y h_z) (Given greater_13 0)) (Mul (Given climb 1) (Given lines 0)) /\
  least_low = Sub (Add (end_of h_x h_y) (Given lesser_1 0)) (Mul (Given climb 1) (Given lines 0)) /\
  least_high = Sub (Add (end_of h_y h_z) (Given lesser_1 0)) (Mul (Given climb 1) (Given lines 0)).
Proof. repeat split; reflexivity. Qed.
Lemma plane_near m : computes32 x (Mul (Given climb 1) (Given lines 0)) m -> Rabs (m - plane) <= 201 / 100 * u * C + few.
Proof.
  intros D. assert (l := h32_below). assert (l0 := h32_positive). simpl in l. fold plane in climbed.
  assert (p0 : 0 <= plane) by (unfold plane; apply Rmult_le_pos; lra).
  destruct (step32_mul _ _ _ _ D) as (c & n & Dc & Dn & R). apply given32_is in Dn. subst n.
  apply given_near in Dc; [| lia | lra]. simpl INR in Dc.
  assert (p1 := Rmult_le_compat_r (x lines) _ _ (proj1 lines_in) Dc). rewrite <- (Rabs_pos_eq (x lines)) in p1 at 1 by lra.
  rewrite <- Rabs_mult in p1. replace (1 * (1001 / 1000) * u * x climb * x lines) with (1001 / 1000 * u * plane) in p1
    by (unfold plane; ring). replace ((c - x climb) * x lines) with (c * x lines - plane) in p1 by (unfold plane; ring).
  apply between in Dc. assert (c1 : Rabs c <= 1073742000) by (apply Rabs_le; lra).
  assert (hd : h32 * (Rabs c + Rabs (x lines) + 1) <= h32 * 1074000000)
    by (apply Rmult_le_compat_l; [lra |]; rewrite (Rabs_pos_eq (x lines)); lra).
  apply between in p1. assert (s1 : Rabs (c * x lines) <= (1 + 2 * u) * C) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ R) in s1. apply between in s1. apply Rabs_le. lra.
Qed.
Lemma side_near e E g G v : Rabs (x e - E) <= 403 / 100 * u * H + few -> 0 <= E <= H ->
  Rabs (x g - G) <= 111 / 10 * u * H + 3 * few -> - H <= G <= H -> computes32 x (over_plane_of e g) v ->
  Rabs (v - (E + G - plane)) <= 192 / 10 * u * H + 31 / 10 * u * C + 6 * few.
Proof.
  intros N I N' I' D. assert (l := h32_below). assert (l0 := h32_positive). simpl in l. fold plane in climbed.
  assert (p0 : 0 <= plane) by (unfold plane; apply Rmult_le_pos; lra).
  destruct (step32_sub _ _ _ _ D) as (a & m & Da & Dm & R). apply plane_near in Dm.
  destruct (step32_add _ _ _ _ Da) as (p & q & Dp & Dq & S). apply given32_is in Dp, Dq. subst p q.
  apply between in N, N', Dm. assert (s1 : Rabs (x e + x g) <= (2 + 16 * u) * H + 4 * few) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ S) in s1. apply between in s1.
  assert (r1 : Rabs (a - m) <= (2 + 20 * u) * H + (1 + 3 * u) * C + 6 * few) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ R) in r1. apply between in r1. apply Rabs_le. lra.
Qed.
Lemma over_in : - H <= over <= H.
Proof.
  destruct (end_near _ _ _ h_x_in h_y_in e0_is) as [_ I0]. destruct (end_near _ _ _ h_y_in h_z_in e1_is) as [_ I1].
  fold E0 in I0. fold E1 in I1. unfold high in *. unfold over.
  assert (A := Rmult_le_compat_l (x rest) _ _ (proj1 rest_in) (proj2 I0)). assert (B := Rmult_le_compat_l (1 - x rest) _ _ ltac:(lra) (proj2 I1)).
  assert (A' := Rmult_le_pos (x rest) E0 ltac:(lra) ltac:(lra)). assert (B' := Rmult_le_pos (1 - x rest) E1 ltac:(lra) ltac:(lra)). lra.
Qed.
Theorem most_near o v : computes32 x (over_of (Given e0 0) (Given e1 0)) o -> x greater_13 = Rmax 0 o ->
  (computes32 x (over_plane_of e0 greater_13) v ->
   Rabs (v - (E0 + Rmax over 0 - plane)) <= 192 / 10 * u * H + 31 / 10 * u * C + 6 * few) /\
  (computes32 x (over_plane_of e1 greater_13) v ->
   Rabs (v - (E1 + Rmax over 0 - plane)) <= 192 / 10 * u * H + 31 / 10 * u * C + 6 * few).
Proof.
  intros Do g_is. apply over_near in Do. assert (O := over_in). apply between in Do.
  assert (N' : Rabs (x greater_13 - Rmax over 0) <= 111 / 10 * u * H + 3 * few /\ - H <= Rmax over 0 <= H).
  { rewrite g_is. unfold Rmax. destruct (Rle_dec 0 o), (Rle_dec over 0); split; try (apply Rabs_le); lra. }
  destruct N' as [N' I']. destruct (end_near _ _ _ h_x_in h_y_in e0_is) as [N0 I0].
  destruct (end_near _ _ _ h_y_in h_z_in e1_is) as [N1 I1]. split; intros D.
  - exact (side_near e0 E0 greater_13 _ v N0 I0 N' I' D).
  - exact (side_near e1 E1 greater_13 _ v N1 I1 N' I' D).
Qed.
Theorem least_near o v : computes32 x (over_of (Given e0 0) (Given e1 0)) o -> x lesser_1 = Rmin 0 o ->
  (computes32 x (over_plane_of e0 lesser_1) v ->
   Rabs (v - (E0 + Rmin over 0 - plane)) <= 192 / 10 * u * H + 31 / 10 * u * C + 6 * few) /\
  (computes32 x (over_plane_of e1 lesser_1) v ->
   Rabs (v - (E1 + Rmin over 0 - plane)) <= 192 / 10 * u * H + 31 / 10 * u * C + 6 * few).
Proof.
  intros Do g_is. apply over_near in Do. assert (O := over_in). apply between in Do.
  assert (N' : Rabs (x lesser_1 - Rmin over 0) <= 111 / 10 * u * H + 3 * few /\ - H <= Rmin over 0 <= H).
  { rewrite g_is. unfold Rmin. destruct (Rle_dec 0 o), (Rle_dec over 0); split; try (apply Rabs_le); lra. }
  destruct N' as [N' I']. destruct (end_near _ _ _ h_x_in h_y_in e0_is) as [N0 I0].
  destruct (end_near _ _ _ h_y_in h_z_in e1_is) as [N1 I1]. split; intros D.
  - exact (side_near e0 E0 lesser_1 _ v N0 I0 N' I' D).
  - exact (side_near e1 E1 lesser_1 _ v N1 I1 N' I' D).
Qed.
(* Bounds at both sides, at the place of a ray between them; and the ray. *)
Let part := 1 - x rest.
Theorem across_near B v : Rabs (x bound_x) <= B -> Rabs (x bound_y) <= B -> Rabs (x bound_y - x bound_x) <= B -> B <= 17179869184 ->
  computes32 x across v -> Rabs (v - (x bound_x + part * (x bound_y - x bound_x))) <= 51 / 10 * u * B + few.
Proof.
  intros B0 B1 B2 B3 D. assert (l := h32_below). assert (l0 := h32_positive). simpl in l.
  destruct (step32_add _ _ _ _ D) as (a & m & Da & Dm & R). apply given32_is in Da. subst a.
  destruct (step32_mul _ _ _ _ Dm) as (r & d & Dr & Dd & S).
  apply step32_diff in Dd. set (F := x bound_y - x bound_x) in *. apply (at_most32 _ _ _ _ Dd) in B2 as Dd'.
  destruct (step32_sub _ _ _ _ Dr) as (p & q & Dp & Dq & V). apply const32_is in Dp. rewrite Q2R_1 in Dp. subst p.
  apply given_near in Dq; [| lia | lra]. simpl INR in Dq. assert (q1 : Rabs (q - x rest) <= 1001 / 1000 * u) by lra. clear Dq.
  apply between in q1. assert (v1 : Rabs (1 - q) <= 1 + 2 * u) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ V) in v1.
  apply between in v1. assert (r1 : Rabs (r - part) <= 2002 / 1000 * u) by (unfold part; apply Rabs_le; lra).
  assert (part_in : 0 <= part <= 1) by (unfold part; lra). assert (r2 := between _ _ r1). assert (d2 := between _ _ Dd').
  assert (B2' := between _ _ B2). assert (d3 : Rabs d <= (1 + 2 * u) * B + 4 * h32) by (apply Rabs_le; lra).
  assert (p1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) r1 d3). rewrite <- Rabs_mult in p1.
  assert (p2 : Rabs (part * (d - F)) <= 1 * (u * B + 4 * h32)).
  { rewrite Rabs_mult, (Rabs_pos_eq (part)) by lra. apply Rmult_le_compat; first [lra | apply Rabs_pos]. }
  assert (r3 : Rabs r <= 1 + 3 * u) by (apply Rabs_le; lra).
  assert (p3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) r3 d3). rewrite <- Rabs_mult in p3.
  assert (hd : h32 * (Rabs r + Rabs d + 1) <= h32 * 20000000000) by (apply Rmult_le_compat_l; lra).
  apply (at_most32 _ _ _ _ S) in p3. apply between in p1, p2, p3.
  assert (m1 : Rabs (m - part * F) <= 403 / 100 * u * B + few / 2) by (apply Rabs_le; lra). apply between in m1.
  apply between in B0, B1. assert (mean : - B <= x bound_x + part * F <= B).
  { unfold F. assert (A := Rmult_le_compat_l (1 - part) _ _ ltac:(lra) (proj2 B0)). assert (A' := Rmult_le_compat_l (1 - part) _ _ ltac:(lra) (proj1 B0)).
    assert (A2 := Rmult_le_compat_l (part) _ _ ltac:(lra) (proj2 B1)). assert (A3 := Rmult_le_compat_l (part) _ _ ltac:(lra) (proj1 B1)). lra. }
  assert (s1 : Rabs (x bound_x + m) <= (1 + 5 * u) * B + few) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ R) in s1.
  apply between in s1. apply Rabs_le. lra.
Qed.
Theorem ray_near v : computes32 x ray v -> Rabs (v - (x height - plane)) <= 202 / 100 * u * H + 302 / 100 * u * C + 2 * few.
Proof.
  intros D. assert (l := h32_below). assert (l0 := h32_positive). simpl in l. unfold high in *. fold plane in climbed.
  assert (p0 : 0 <= plane) by (unfold plane; apply Rmult_le_pos; lra).
  destruct (step32_sub _ _ _ _ D) as (a & m & Da & Dm & R). apply plane_near in Dm.
  apply given_near in Da; [| lia | lra]. simpl INR in Da. apply between in Da, Dm.
  assert (r1 : Rabs (a - m) <= (1 + 2 * u) * H + (1 + 3 * u) * C + few) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ R) in r1. apply between in r1. apply Rabs_le. lra.
Qed.
(* What is kept of a line: the greater of its bound and of the last line's, with the bends between both. *)
Definition lost_of_line := 61 * u * H + 42 / 10 * u * C + 12 * few.
Definition kept_of bends met := Add (Given bends 0) (Given met 0).
Definition at_rest_0 i j g := Sub (Add (Add (Given i 0) (Times 0 (Diff j i))) (Given g 0)) (Times 0 (Given light_5 0)).
Lemma kept_is : (* meet_line(): of a side's bound, the one met last, and the bends *)
  greater_22_one = kept_of greater_19 greater_21 /\ greater_24_one = kept_of greater_19 greater_23 /\
  greater_21_one = Given last_low 0 /\ greater_21_other = at_rest_0 copy_1 copy_2 greater_20 /\
  greater_23_one = Given last_high 0 /\ greater_23_other = at_rest_0 copy_2 copy_3 greater_20 /\
  greater_19_one = Add (Add (Given greater_14 0) (Given greater_15 0)) (Given greater_16 0) /\
  greater_19_other = Add (Add (Given greater_15 0) (Given greater_17 0)) (Given greater_18 0).
Proof. repeat split. Qed.
Theorem line_is_kept a b v R1 R2 S : R1 <= x a + (192 / 10 * u * H + 31 / 10 * u * C + 6 * few) ->
  R2 <= x a + (192 / 10 * u * H + 31 / 10 * u * C + 6 * few) -> S <= x b + 34 * u * H + 4 * few ->
  Rabs (x a) <= 3 * H + C + few -> 0 <= x b <= 4 * H + few -> computes32 x (kept_of b a) v ->
  Rmax R1 R2 + S <= v + lost_of_line.
Proof.
  intros A1 A2 B A0 B0 D. assert (l := h32_below). simpl in l. unfold lost_of_line.
  destruct (step32_add _ _ _ _ D) as (p & q & Dp & Dq & R). apply given32_is in Dp, Dq. subst p q. apply between in A0.
  assert (s1 : Rabs (x b + x a) <= 7 * H + C + 2 * few) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ R) in s1.
  apply between in s1. assert (M := Rmax_lub _ _ _ A1 A2). lra.
Qed.
(* The margin: M0 and M1 bound the ground over the plane at both sides, and are above what is kept, x bound_x and x bound_y, by
   what a line loses; those are within 5 H and C of each other. Where that is below a ray less its margin, as both are computed,
   the ground is below the ray; it is above the ray where what is kept of a lowered line is above the ray and its margin. *)
Definition least_of_heights : Q := 93 # 1.
Definition least_of_climb : Q := 15 # 1.
Definition least_lost : Q := (18 # 1) * lost.
Hypotheses (B_x : Rabs (x bound_x) <= 5 * H + C) (B_y : Rabs (x bound_y) <= 5 * H + C).
Hypothesis B_xy : Rabs (x bound_y - x bound_x) <= 5 * H + C.
Variable margin : R.
Hypothesis margin_is : 93 * u * H + 15 * u * C + 18 * few <= margin.
Theorem strip_is_below M0 M1 a r b : M0 <= x bound_x + lost_of_line -> M1 <= x bound_y + lost_of_line ->
  computes32 x across a -> computes32 x ray r -> Rabs (b - (r - margin)) <= u * Rabs (r - margin) + 4 * h32 -> a < b ->
  M0 + part * (M1 - M0) < x height - plane.
Proof.
  intros L0 L1 Da Dr Hb less. assert (part_in : 0 <= part <= 1) by (unfold part; lra). assert (l := h32_below). simpl in l. unfold lost_of_line, high in *.
  apply (across_near (5 * H + C)) in Da; auto; [| lra]. apply ray_near in Dr. fold plane in climbed.
  assert (p0 : 0 <= plane) by (unfold plane; apply Rmult_le_pos; lra).
  assert (K0 := Rmult_le_compat_l (1 - part) _ _ ltac:(lra) L0). assert (K1 := Rmult_le_compat_l (part) _ _ ltac:(lra) L1).
  apply between in Da, Dr. assert (b1 : Rabs (r - margin) <= (1 + 10 * u) * (H + C) + 3 * few + margin) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ Hb) in b1. apply between in b1. lra.
Qed.
Theorem strip_is_above M0 M1 a r b : x bound_x - lost_of_line <= M0 -> x bound_y - lost_of_line <= M1 ->
  computes32 x across a -> computes32 x ray r -> Rabs (b - (r + margin)) <= u * Rabs (r + margin) + 4 * h32 -> b < a ->
  x height - plane < M0 + part * (M1 - M0).
Proof.
  intros L0 L1 Da Dr Hb more. assert (part_in : 0 <= part <= 1) by (unfold part; lra). assert (l := h32_below). simpl in l. unfold lost_of_line, high in *.
  apply (across_near (5 * H + C)) in Da; auto; [| lra]. apply ray_near in Dr. fold plane in climbed.
  assert (p0 : 0 <= plane) by (unfold plane; apply Rmult_le_pos; lra).
  assert (K0 := Rmult_le_compat_l (1 - part) _ _ ltac:(lra) L0). assert (K1 := Rmult_le_compat_l (part) _ _ ltac:(lra) L1).
  apply between in Da, Dr. assert (b1 : Rabs (r + margin) <= (1 + 10 * u) * (H + C) + 3 * few + margin) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ Hb) in b1. apply between in b1. lra.
Qed.
End Strip.
Lemma kernel_is_enough : (least_of_sizes <= value_of of_sizes /\ least_lost <= (99 # 100) * value_of of_nothing /\
  least_of_heights <= value_of of_heights <= 1000 /\ least_of_climb <= value_of of_climb <= 1000)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_of_sizes (value_of of_sizes).
Print constants.
Definition rests := Eval vm_compute in shown least_of_heights (value_of of_heights).
Print rests.
Definition others := Eval vm_compute in shown least_of_climb (value_of of_climb).
Print others.
Definition checked := (lit_is_above, dark_is_below, walked_near, bent_is_below, kink, along_the_ray, rising_bends, falling_bends,
  across_a_strip, greatest_at_ends, kernels_bends, bend_near, sum_of_bends, over_is, sides_are, most_near,
  kept_is, least_near, across_near, ray_near, line_is_kept, strip_is_below, strip_is_above, kernel_is_enough).
Print Assumptions checked.
