(* SPDX-License-Identifier: MIT *)
(* strip_triangle.clh: the slopes at which a strip meets a triangle, against SLOPE_ERROR (height + slope x distance) /
  q, and
   the height of a triangle's plane over the point, against 2^-17 farthest^2 highest. From the corners' coordinates on:
     q_near, across_near, height_near   a corner's numbers: 4e-7 of its distance, and 2 roundings;
     between_near, corner_near          the slope of a place of an edge, and of a corner;
     over_near                          the height over the point;
     height_near32                      what underflow takes of a height, denormals kept or flushed: 37 x 2^-126 units;
     underflow_is_covered               a slope's error has room for that, since a sector's lights rise by
                                        SECTOR_LEAST_RISE (make_sector_bundles() leaves others to beams).

   Assumed: a sector's vectors are unit vectors times `halves`, off by two roundings, so no coordinate exceeds
     `halves`; a
   quotient is off by 2.5 ulp; but in the last two, no result is below
   2^-126 unless it is 0; `units` is at least 1/32, since no height exceeds 2^20; cells are not below FIELD_LEAST_CELL;
   areas are off by 2^-19 farthest^2
     (horizons.v) and
   at most 2.01 farthest^2; no q exceeds 1.001 farthest, no height `highest`; a corner within the strip is at most 64
     q away
   (its width is at most 40 q). In prose (strip_triangle.clh): a place on an edge that is computed lies on the real edge
   within STRIP_MARGIN of the strip's side. may_touch() compares with 2^-19 of the distance, the areas' constant,
     where q and
   across need 6 u and the width 8 u. Overflow: coordinates are below 2^20 half cells, heights below 2^20 units. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition a_z := 2%nat.
Definition at_x := 3%nat.
Definition at_y := 4%nat.
Definition at_z := 5%nat.
Definition halves := 6%nat.
Definition units := 7%nat.
Definition q_i := 8%nat.
Definition q_j := 9%nat.
Definition height_i := 10%nat.
Definition height_j := 11%nat.
Definition height_k := 12%nat.
Definition size_i := 13%nat.
Definition size_j := 14%nat.
Definition farthest := 15%nat.
Definition highest := 16%nat.
Definition areas_x := 17%nat.
Definition areas_y := 18%nat.
Definition areas_z := 19%nat.
Definition sector_0_0 := 20%nat.
Definition sector_0_1 := 21%nat.
Definition sector_1_0 := 22%nat.
Definition sector_1_1 := 23%nat.
Definition quotient_1 := 24%nat.
Definition quotient_2 := 25%nat.
Definition q :=
  Fma (Given sector_0_0 2) (Diff a_x at_x) (Mul (Given sector_0_1 2) (Diff a_y at_y)).
Definition across :=
  Fma (Given sector_1_0 2) (Diff a_x at_x) (Mul (Given sector_1_1 2) (Diff a_y at_y)).
Definition height :=
  Mul (Given units 0) (Diff a_z at_z).
Definition distance :=
  Mul (Add (Abs (Diff a_x at_x)) (Abs (Diff a_y at_y))) (Given halves 0).
Definition distance_rest : Q := 1 # 1099511627776.
Definition quotient_1_over :=
  Const (1 # 1).
Definition quotient_1_under :=
  Fma (Given q_i 0) (Given size_j 0) (Mul (Given q_j 0) (Given size_i 0)).
Definition slope :=
  Mul (Given quotient_1 5) (Fma (Given height_i 0) (Given size_j 0) (Mul (Given height_j 0) (Given size_i 0))).
Definition q_between :=
  quotient_1_under.
Definition slope_bound :=
  Mul (Given quotient_1 5) (Mul (Fma (Abs slope) (Given farthest 0) (Given highest 0)) (Times (8796093 #
    8796093022208) (Add (Given size_i 0) (Given size_j 0)))).
Definition quotient_2_over :=
  quotient_1_over.
Definition quotient_2_under := Given q_i 0.
Definition corner :=
  Mul (Given quotient_2 5) (Given height_i 0).
Definition corner_bound :=
  Mul (Given quotient_2 5) (Times (8796093 # 8796093022208) (Fma (Abs corner) (Given farthest 0) (Given highest
    0))).
(* least = least_constant * (Given units 0) *)
Definition least_constant : Q := 8796093 # 8796093022208.
Definition over :=
  Fma (Given areas_z 0) (Given height_k 0) (Fma (Given areas_y 0) (Given height_j 0) (Fma (Given areas_x 0) (Given
    height_i 0) (Const (0 # 1)))).
Definition over_bound :=
  Mul (Given highest 0) (Mul (Given farthest 0) (Times (1 # 131072) (Given farthest 0))).
(* end: from the kernels *)

Open Scope R_scope.

(* ---- A corner's numbers ---- *)
Section Corner.
Variable x : nat -> R.
Hypotheses (along_x : Rabs (x sector_0_0) <= x halves) (along_y : Rabs (x sector_0_1) <= x halves).
Hypotheses (across_x : Rabs (x sector_1_0) <= x halves) (across_y : Rabs (x sector_1_1) <= x halves).
Local Notation computed := (computed x).


Lemma along_strip_near s t v d : Rabs (x s) <= x halves -> Rabs (x t) <= x halves ->
  computed (Fma (Given s 2) (Diff a_x at_x) (Mul (Given t 2) (Diff a_y at_y))) v -> computed distance d ->
  Rabs (v - (x s * (x a_x - x at_x) + x t * (x a_y - x at_y))) <= 4 / 10000000 * d.
Proof.
  intros Hs Ht Cv Cd. apply near in Cv. apply near in Cd. cbn -[u32 alpha] in Cv, Cd.
  assert (H0 : 0 <= x halves) by (eapply Rle_trans; [apply Rabs_pos | exact Hs]).
  rewrite ?Rabs_Rabsolu in *. rewrite (Rabs_pos_eq (x halves)) in Cd by exact H0.
  set (p := Rabs (x a_x - x at_x)) in *. set (r := Rabs (x a_y - x at_y)) in *.
  assert (0 <= p) by apply Rabs_pos. assert (0 <= r) by apply Rabs_pos.
  assert (P : Rabs (x s) * p + Rabs (x t) * r <= (p + r) * x halves).
  { assert (A := Rmult_le_compat_r p _ _ ltac:(lra) Hs). assert (B := Rmult_le_compat_r r _ _ ltac:(lra) Ht). lra. }
  assert (D0 : 0 <= (p + r) * x halves) by (apply Rmult_le_pos; lra).
  assert (A5 := alpha_below 5 ltac:(lia)). assert (A3 := alpha_below 3 ltac:(lia)). simpl INR in A5, A3.
  assert (Z5 : 0 <= alpha u32 5) by (apply alpha_positive; apply bpow_ge_0).
  assert (E5 : alpha u32 5 * (Rabs (x s) * p + Rabs (x t) * r) <= (1 + 1 + 1 + 1 + 1) * (1 + / 1048576) * / 16777216 *
    ((p + r) * x halves)) by (apply Rmult_le_compat; auto; apply Rplus_le_le_0_compat; apply Rmult_le_pos; auto using
      Rabs_pos).
  assert (E3 := Rmult_le_compat_r _ _ _ D0 A3). apply between in Cd. lra.
Qed.

Theorem q_near v d : computed q v -> computed distance d -> Rabs (v - real x q) <= 4 / 10000000 * d.
Proof. intros. now apply along_strip_near. Qed.
Theorem across_near v d : computed across v -> computed distance d -> Rabs (v - real x across) <= 4 / 10000000 * d.
Proof. intros. now apply along_strip_near. Qed.
Theorem height_near v : computed height v -> Rabs (v - real x height) <= 201 / 100 * / 16777216 * Rabs (real x height).
Proof.
  intros C. apply near in C. assert (A2 := alpha_below 2 ltac:(lia)). simpl INR in A2.
  cbn -[u32 alpha] in *. rewrite Rabs_mult.
  assert (P := Rmult_le_pos _ _ (Rabs_pos (x units)) (Rabs_pos (x a_z - x at_z))).
  assert (E := Rmult_le_compat_r _ _ _ P A2). lra.
Qed.
End Corner.

(* ---- Slopes ---- *)

(* A computed slope s of a height v_h at v_q; H and Q are the real ones. *)
Definition of_slope := 6 / 10000000.
Lemma slope_moves s v_h v_q H Q F h S :
  0 < v_q -> 0 < S -> 0 <= F -> 0 <= h -> F * S <= 65 * v_q ->
  Rabs (v_h - H) <= 402 / 100 * / 16777216 * (h * S) -> Rabs (v_q - Q) <= 54 / 100000000 * (F * S) ->
  Rabs v_h <= 1001 / 1000 * (h * S) -> Rabs (s - v_h / v_q) <= 601 / 100 * / 16777216 * Rabs (v_h / v_q) ->
  Rabs (s - H / Q) <= of_slope * ((Rabs s * F + h) * S / v_q).
Proof.
  intros q0 S0 F0 h0 far Hh Hq large Hs. unfold of_slope. set (r := v_h / v_q) in *. set (t := S / v_q).
  assert (t0 : 0 < t) by (unfold t; apply Rdiv_lt_0_compat; lra).
  assert (Ft : 0 <= F * t) by (apply Rmult_le_pos; lra).
  assert (least : (1 - 36 / 1000000) * v_q <= Q) by (apply between in Hq; lra).
  assert (Q0 : 0 < Q) by lra.
  assert (inverse : / Q <= (1 + 4 / 100000) * / v_q).
  { replace ((1 + 4 / 100000) * / v_q) with (/ (v_q / (1 + 4 / 100000))) by (field; repeat split; lra).
    apply Rinv_le_contravar; [apply Rdiv_lt_0_compat; lra |]. unfold Rdiv. lra. }
  assert (r_size : Rabs r <= 1001 / 1000 * (h * t)).
  { unfold r, t, Rdiv. rewrite Rabs_mult, Rabs_inv, (Rabs_pos_eq v_q) by lra.
    assert (I := Rinv_0_lt_compat _ q0). assert (G := Rmult_le_compat_r (/ v_q) _ _ ltac:(lra) large). lra. }
  replace (s - H / Q) with ((s - r) + ((v_h - H) + - (r * (v_q - Q))) * / Q) by (unfold r; field; repeat split; lra).
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_mult, Rabs_inv, (Rabs_pos_eq Q) by lra.
  assert (T := Rabs_triang (v_h - H) (- (r * (v_q - Q)))). rewrite Rabs_Ropp, Rabs_mult in T.
  assert (G1 := Rmult_le_compat_l _ _ _ (Rabs_pos r) Hq).
  assert (G2 : Rabs (v_h - H + - (r * (v_q - Q))) * / Q <=
    (402 / 100 * / 16777216 * (h * S) + Rabs r * (54 / 100000000 * (F * S))) * ((1 + 4 / 100000) * / v_q)).
  { apply Rmult_le_compat; auto using Rabs_pos; try lra. left. apply Rinv_0_lt_compat; lra. }
  replace ((402 / 100 * / 16777216 * (h * S) + Rabs r * (54 / 100000000 * (F * S))) * ((1 + 4 / 100000) * / v_q)) with
    ((402 / 100 * / 16777216 * (h * t) + 54 / 100000000 * (Rabs r * (F * t))) * (1 + 4 / 100000)) in G2
    by (unfold t; field; repeat split; lra).
  replace ((Rabs s * F + h) * S / v_q) with (Rabs s * (F * t) + h * t) by (unfold t; field; repeat split; lra).
  assert (s_size : Rabs r <= (1 + 1 / 1000000) * Rabs s).
  { assert (r0 := Rabs_pos r). assert (U := Rabs_triang_inv r (r - s)). replace (r - (r - s)) with s in U by ring.
    rewrite Rabs_minus_sym in Hs. lra. }
  assert (G3 := Rmult_le_compat_r _ _ _ Ft s_size). assert (0 <= Rabs s * (F * t)) by (apply Rmult_le_pos; auto using
    Rabs_pos).
  assert (ht : 0 <= h * t) by (apply Rmult_le_pos; lra). lra.
Qed.

Section Slopes.
Variable x : nat -> R.
(* The real numbers of the two corners. *)
Variables Q_i Q_j H_i H_j : R.
Hypotheses (sizes_i : 0 <= x size_i) (sizes_j : 0 <= x size_j) (sizes : 0 < x size_i + x size_j).
Hypotheses (F0 : 0 <= x farthest) (h0 : 0 <= x highest).
Hypotheses (q_i_near : Rabs (x q_i - Q_i) <= 4 / 10000000 * x farthest).
Hypotheses (q_j_near : Rabs (x q_j - Q_j) <= 4 / 10000000 * x farthest).
Hypotheses (h_i_near : Rabs (x height_i - H_i) <= 2011 / 1000 * / 16777216 * x highest).
Hypotheses (h_j_near : Rabs (x height_j - H_j) <= 2011 / 1000 * / 16777216 * x highest).
Hypotheses (h_i_in : Rabs (x height_i) <= x highest) (h_j_in : Rabs (x height_j) <= x highest).
Hypotheses (q_i_in : Rabs (x q_i) <= 1001 / 1000 * x farthest) (q_j_in : Rabs (x q_j) <= 1001 / 1000 * x farthest).
Let S := x size_i + x size_j.

(* A mean of two numbers, each wrong by e, times both sizes. *)
Lemma mean_near a b A B e : Rabs (a - A) <= e -> Rabs (b - B) <= e ->
  Rabs ((x size_j * a + x size_i * b) - (x size_j * A + x size_i * B)) <= e * S.
Proof.
  intros Ha Hb. replace (x size_j * a + x size_i * b - (x size_j * A + x size_i * B)) with
    (x size_j * (a - A) + x size_i * (b - B)) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult, (Rabs_pos_eq (x size_i)), (Rabs_pos_eq (x size_j)) by
    assumption.
  assert (P := Rmult_le_compat_l _ _ _ sizes_j Ha). assert (Q := Rmult_le_compat_l _ _ _ sizes_i Hb). unfold S. lra.
Qed.
Lemma mean_in a b M : Rabs a <= M -> Rabs b <= M -> Rabs a * x size_j + Rabs b * x size_i <= M * S.
Proof.
  intros Ha Hb. assert (P := Rmult_le_compat_r _ _ _ sizes_j Ha). assert (Q := Rmult_le_compat_r _ _ _ sizes_i Hb).
  unfold S. lra.
Qed.

(* The computed means: the height's, and q's. *)
Definition mean_height := match slope with Mul _ m => m | _ => Const 0 end.
Lemma mean_computed a b e v M : e = Fma (Given a 0) (Given size_j 0) (Mul (Given b 0) (Given size_i 0)) ->
  Rabs (x a) <= M -> Rabs (x b) <= M -> computed x e v ->
  Rabs (v - (x size_j * x a + x size_i * x b)) <= 2001 / 1000 * / 16777216 * (M * S).
Proof.
  intros -> Ha Hb C. apply near in C. cbn -[u32 alpha] in C. rewrite (Rabs_pos_eq (x size_i)), (Rabs_pos_eq (x
    size_j)) in C by assumption.
  assert (A := alpha_below 2 ltac:(lia)). simpl INR in A. assert (P := mean_in _ _ M Ha Hb).
  assert (Z : 0 <= alpha u32 2) by (apply alpha_positive; apply bpow_ge_0).
  assert (P0 : 0 <= Rabs (x a) * x size_j + Rabs (x b) * x size_i).
  { apply Rplus_le_le_0_compat; apply Rmult_le_pos; auto using Rabs_pos. }
  assert (E := Rmult_le_compat _ _ _ _ Z P0 A P).
  replace (x size_j * x a + x size_i * x b) with (x a * x size_j + x b * x size_i) by ring. lra.
Qed.

(* v_q and v_h are the computed means, s the computed slope: a quotient and a product after them. *)
Theorem between_near v_q v_h s :
  computed x q_between v_q -> computed x mean_height v_h -> x farthest * S <= 65 * v_q -> 0 < v_q ->
  Rabs (s - v_h / v_q) <= 601 / 100 * / 16777216 * Rabs (v_h / v_q) ->
  Rabs (s - (x size_j * H_i + x size_i * H_j) / (x size_j * Q_i + x size_i * Q_j)) <=
  of_slope * ((Rabs s * x farthest + x highest) * S / v_q).
Proof.
  intros Cq Ch far q0 Hs.
  assert (hS : 0 <= x highest * S) by (unfold S; apply Rmult_le_pos; lra).
  assert (FS : 0 <= x farthest * S) by (unfold S; apply Rmult_le_pos; lra).
  assert (Nq := mean_computed _ _ _ _ _ eq_refl q_i_in q_j_in Cq).
  assert (Nh := mean_computed _ _ _ _ _ eq_refl h_i_in h_j_in Ch).
  assert (Mq := mean_near _ _ _ _ _ q_i_near q_j_near). assert (Mh := mean_near _ _ _ _ _ h_i_near h_j_near).
  apply slope_moves with (v_h := v_h) (v_q := v_q); auto.
  - unfold S in *. apply between in Nh. apply between in Mh. apply Rabs_le. lra.
  - unfold S in *. apply between in Nq. apply between in Mq. apply Rabs_le. lra.
  - assert (I := mean_in _ _ _ h_i_in h_j_in).
    assert (T := Rabs_triang (x size_j * x height_i) (x size_i * x height_j)).
    rewrite !Rabs_mult, (Rabs_pos_eq (x size_i)), (Rabs_pos_eq (x size_j)) in T by assumption.
    assert (U := Rabs_triang (v_h - (x size_j * x height_i + x size_i * x height_j))
      (x size_j * x height_i + x size_i * x height_j)).
    replace (v_h - (x size_j * x height_i + x size_i * x height_j) + (x size_j * x height_i + x size_i * x height_j))
      with v_h in U by ring. unfold S in *. lra.
Qed.

(* d: the corner's own distance. *)
Theorem corner_near s d :
  Rabs (x q_i - Q_i) <= 4 / 10000000 * d -> 0 <= d <= x farthest -> d <= 64 * x q_i -> 0 < x q_i ->
  Rabs (s - x height_i / x q_i) <= 601 / 100 * / 16777216 * Rabs (x height_i / x q_i) ->
  Rabs (s - H_i / Q_i) <= of_slope * ((Rabs s * x farthest + x highest) * 1 / x q_i).
Proof.
  intros Hq [d0 Hd] far q0 Hs.
  eapply Rle_trans; [apply slope_moves with (v_h := x height_i) (v_q := x q_i) (F := d) (h := x highest) (S := 1);
    auto; lra |].
  assert (I := Rinv_0_lt_compat _ q0). assert (P := Rmult_le_compat_l _ _ _ (Rabs_pos s) Hd).
  assert (G : (Rabs s * d + x highest) * 1 / x q_i <= (Rabs s * x farthest + x highest) * 1 / x q_i).
  { unfold Rdiv. apply Rmult_le_compat_r; lra. }
  unfold of_slope. lra.
Qed.
End Slopes.

(* The kernel's bounds have only positive terms and one quotient, off by 5 roundings, which they are multiplied with. *)
Definition slope_error : Q := match corner_bound with Mul _ (Times c _) => c | _ => 0%Q end.
Lemma error_is : slope_bound =
  Mul (Given quotient_1 5) (Mul (Fma (Abs slope) (Given farthest 0) (Given highest 0))
                                (Times slope_error (Add (Given size_i 0) (Given size_j 0)))).
Proof. reflexivity. Qed.
(* `slope` is a number of the bound, not one of its roundings. *)
Definition least_error := Eval vm_compute in
  ((6 # 10000000) / (1 - alphaQ u32Q (roundings slope_bound - roundings slope)))%Q.

(* ---- What underflow takes of a height, denormals kept or flushed ---- *)
Section Underflow.
Variable x : nat -> R.
Hypothesis units_in : / 32 <= x units.
Definition may_lose (i : nat) : Q := if Nat.eqb i units then 0 else h32Q.
Lemma units_are_kept : keeps x may_lose.
Proof.
  intros i. unfold may_lose. destruct (Nat.eqb_spec i units) as [-> |]; [right | now left]. split; [reflexivity |].
  right. assert (h := h32_below). simpl in h. rewrite Rabs_pos_eq; lra.
Qed.
Theorem height_near32 v : computes32 x height v ->
  Rabs (v - real x height) <= 201 / 100 * / 16777216 * Rabs (real x height) + 37 * h32 * x units.
Proof.
  intros C. assert (K := computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near seen32_near
    x (fun i => Q2R (may_lose i)) (keeps_range x _ units_are_kept) (keeps_near x _ units_are_kept) _ v C).
  assert (A2 := alpha_below 2 ltac:(lia)). simpl INR in A2. assert (h := h32_positive).
  cbn -[u32 h32 alpha may_lose] in *. unfold of_product in K. replace (Q2R (may_lose units)) with 0 in K
    by (unfold may_lose; simpl; now rewrite Q2R_0').
  rewrite Rabs_mult. rewrite u32_value in *. rewrite (Rabs_pos_eq (x units)) in * by lra.
  assert (P : 0 <= x units * Rabs (x a_z - x at_z)) by (apply Rmult_le_pos; [lra | apply Rabs_pos]).
  assert (E := Rmult_le_compat_r _ _ _ P A2).
  assert (A0 : alpha (/ 16777216) 0 = 0) by (unfold alpha; simpl; lra). rewrite A0 in K.
  assert (hu := Rmult_le_compat_l h32 _ _ ltac:(lra) units_in). lra.
Qed.
End Underflow.

(* A sector's lights rise by 1e-6 at least (SECTOR_LEAST_RISE), so that their slopes are not below `least`. A slope that
   is not below .9 of that has room for what underflow takes of heights: SLOPE_ERROR has 3e-7 more than of_slope. *)
Lemma underflow_is_covered slope_ U L F : 0 < U -> 0 < L <= 34359738368 -> / 1099511627776 <= F ->
  9 / 10 * (Q2R least_constant * U / L) <= slope_ -> 37 * h32 * U <= 3 / 10000000 * (slope_ * F).
Proof.
  intros U0 [L0 L1] F0 S. assert (h := h32_below). simpl in h.
  assert (r : 999 / 1000000000 <= Q2R least_constant) by (unfold Q2R, least_constant; simpl; lra).
  assert (I : / 34359738368 <= / L) by (apply Rinv_le_contravar; lra).
  assert (I0 : 0 <= / 34359738368) by lra.
  assert (Z : 0 <= 999 / 1000000000 * U) by lra.
  assert (G := Rmult_le_compat _ _ _ _ Z I0 (Rmult_le_compat_r U _ _ ltac:(lra) r) I).
  unfold Rdiv in S. assert (S0 : 9 / 10 * (999 / 1000000000 * U * / 34359738368) <= slope_) by lra.
  assert (N : 0 <= 9 / 10 * (999 / 1000000000 * U * / 34359738368)) by lra.
  assert (E : 0 <= / 1099511627776) by lra. assert (W := Rmult_le_compat _ _ _ _ N E S0 F0).
  assert (H := Rmult_le_compat_r U _ _ ltac:(lra) h). lra.
Qed.

(* ---- The height over the point ---- *)
Section Over.
Variable x : nat -> R.
Variables A B C H I J : R.  (* the real areas and heights *)
Let F := x farthest * x farthest.
Hypotheses (F0 : 0 <= x farthest) (h0 : 0 <= x highest).
Let right_area i a := Rabs (x i - a) <= / 524288 * F /\ Rabs (x i) <= 201 / 100 * F.
Let right_height i h := Rabs (x i - h) <= 201 / 100 * / 16777216 * Rabs h /\ Rabs (x i) <= x highest.
Hypotheses (a_x : right_area areas_x A) (a_y : right_area areas_y B) (a_z : right_area areas_z C).
Hypotheses (h_i : right_height height_i H) (h_j : right_height height_j I) (h_k : right_height height_k J).

Lemma term_near i a j h : right_area i a -> right_height j h ->
  Rabs (x i * x j - a * h) <= (/ 524288 + 405 / 100 * / 16777216) * (F * x highest) /\
  Rabs (x i) * Rabs (x j) <= 201 / 100 * (F * x highest).
Proof.
  intros [Na Ia] [Nh Ih]. assert (f0 : 0 <= F) by (unfold F; apply Rmult_le_pos; lra). split.
  - assert (size : Rabs h <= 10001 / 10000 * x highest).
    { assert (T := Rabs_triang (x j) (h - x j)). replace (x j + (h - x j)) with h in T by ring.
      rewrite Rabs_minus_sym in Nh. lra. }
    replace (x i * x j - a * h) with (x i * (x j - h) + (x i - a) * h) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult.
    assert (Nh' : Rabs (x j - h) <= 2011 / 1000 * / 16777216 * x highest) by lra.
    assert (P := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Ia Nh').
    assert (Q := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Na size).
    assert (0 <= F * x highest) by (apply Rmult_le_pos; lra). lra.
  - rewrite <- Rmult_assoc. apply Rmult_le_compat; auto using Rabs_pos.
Qed.

(* 2^-17 less the bound's own roundings. *)
Theorem over_near v : computed x over v -> Rabs (v - (A * H + B * I + C * J)) <= 1271 / 10 * / 16777216 * (F * x
  highest).
Proof.
  intros Cv. apply near in Cv. cbn -[u32 alpha Q2R] in Cv. replace (Q2R (0 # 1)) with 0 in Cv by (unfold Q2R; simpl;
    lra). rewrite Rabs_R0 in Cv.
  destruct (term_near _ _ _ _ a_x h_i) as [N1 I1]. destruct (term_near _ _ _ _ a_y h_j) as [N2 I2].
  destruct (term_near _ _ _ _ a_z h_k) as [N3 I3].
  assert (A3 := alpha_below 3 ltac:(lia)). simpl INR in A3.
  assert (Z : 0 <= alpha u32 3) by (apply alpha_positive; apply bpow_ge_0).
  set (P := Rabs (x areas_z) * Rabs (x height_k) + (Rabs (x areas_y) * Rabs (x height_j) +
    (Rabs (x areas_x) * Rabs (x height_i) + 0))) in *.
  assert (P0 : 0 <= P).
  { unfold P. assert (W := fun i j => Rmult_le_pos _ _ (Rabs_pos (x i)) (Rabs_pos (x j))).
    assert (W1 := W areas_x height_i). assert (W2 := W areas_y height_j). assert (W3 := W areas_z height_k). lra. }
  assert (P1 : P <= 603 / 100 * (F * x highest)) by (unfold P; lra).
  assert (E := Rmult_le_compat _ _ _ _ Z P0 A3 P1).
  apply between in N1. apply between in N2. apply between in N3. apply between in Cv. apply Rabs_le. lra.
Qed.
End Over.
Definition over_error : Q := match over_bound with Mul _ (Mul _ (Times c _)) => c | _ => 0%Q end.
Definition least_over := Eval vm_compute in ((1271 # 10) * (1 # 2 ^ 24) / (1 - alphaQ u32Q (roundings over_bound)))%Q.

Definition constants := Eval vm_compute in shown least_error slope_error.
Print constants.
Definition rests := Eval vm_compute in shown least_over over_error.
Print rests.
Definition checked := (q_near, across_near, height_near, height_near32, underflow_is_covered, between_near, corner_near, over_near).
Print Assumptions checked.
