(* SPDX-License-Identifier: MIT *)
(* loose others: 1e-6 is a sun a fifth of an arc second high, not worth a sector; normal slopes need far less *)
(* strip_triangle.clh: the slopes at which a strip meets a triangle, against SLOPE_ERROR (height + slope x distance) / q, and
   the height of a triangle's plane over the point, against 2^-17 farthest^2 highest. From the corners' coordinates on:
     q_near, across_near, height_near   a corner's numbers: 4e-7 of its distance and 2^-86; 2 roundings, and HEIGHT_NEAR;
     between_near, corner_near          the slope of a place of an edge, and of a corner;
     over_near                          the height over the point;
     lights_are_normal                  a sector's lights, which rise by SECTOR_LEAST_RISE, have slopes that do not underflow.

   Assumed: a sector's vectors are unit vectors times `halves`, off by two roundings, so no coordinate exceeds `halves`, up to
   2^35 (no cell is below FIELD_LEAST_CELL); a unit of length has 1/32 to 2^76 units of height (no height exceeds 2^20; see
   pyramid_slopes.v); corners are up to 2^20 half cells and units of length away; a quotient is off by 2.5 ulp; areas are off
   by 2^-19 farthest^2 (horizons.v) and at most 2.01 farthest^2; `farthest` is at least 2^-40 (FIELD_NEAR), no q exceeds 1.001
   farthest, no height `highest`, which is HEIGHT_NEAR at least, so that it bounds what underflow takes, too; a crossing's q
   exceeds CROSSING_NEAR, and 1/65 of the distance times both sizes; a corner's exceeds CORNER_NEAR, and a corner within the
   strip is at most 64 q away (its width is at most 40 q). Denormals may be kept or flushed. In prose (strip_triangle.clh): a
   place on an edge that is computed lies on the real edge within STRIP_MARGIN of the strip's side. may_touch() compares with
   2^-19 of the distance, the areas' constant, where q and across need 6 u and the width 8 u. Overflow: coordinates are below
   2^20 half cells, heights below 2^20 units, a strip's sides within 2^25. *)
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
Definition highest_of :=
  Add (Abs (Mul (Given units 0) (Diff a_z at_z))) (Const (1 # 65536)).
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
Definition least_of_crossing :=
  Const (1 # 8796093022208).
Definition least_of_corner :=
  Const (1 # 1152921504606846976).
Definition over :=
  Fma (Given areas_z 0) (Given height_k 0) (Fma (Given areas_y 0) (Given height_j 0) (Fma (Given areas_x 0) (Given
    height_i 0) (Const (0 # 1)))).
Definition over_bound :=
  Mul (Given highest 0) (Mul (Given farthest 0) (Times (1 # 131072) (Given farthest 0))).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation lost_of_q := (/ 77371252455336267181195264).  (* 2^-86 *)
Definition value_of e : Q := match e with Const c => c | _ => 0%Q end.

(* ---- A corner's numbers ---- *)
Section Corner.
Variable x : nat -> R.
Hypotheses (along_x : Rabs (x sector_0_0) <= x halves) (along_y : Rabs (x sector_0_1) <= x halves).
Hypotheses (across_x : Rabs (x sector_1_0) <= x halves) (across_y : Rabs (x sector_1_1) <= x halves).
Hypothesis halves_in : x halves <= 34359738368.
Hypotheses (x_in : Rabs (x a_x - x at_x) <= 1048576) (y_in : Rabs (x a_y - x at_y) <= 1048576).
Local Notation computed := (computes32 x).

Lemma along_strip_near s t v d : Rabs (x s) <= x halves -> Rabs (x t) <= x halves ->
  computed (Fma (Given s 2) (Diff a_x at_x) (Mul (Given t 2) (Diff a_y at_y))) v -> computed distance d ->
  Rabs (v - (x s * (x a_x - x at_x) + x t * (x a_y - x at_y))) <= 4 / 10000000 * d + lost_of_q.
Proof.
  intros Hs Ht Cv Cd. apply near32 in Cv. apply near32 in Cd. unfold lost32 in Cv, Cd. cbn -[u32 h32 alpha] in Cv, Cd.
  unfold of_product in Cv, Cd. assert (z : alpha u32 0 = 0) by (unfold alpha; simpl; lra).
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  assert (H0 : 0 <= x halves) by (eapply Rle_trans; [apply Rabs_pos | exact Hs]).
  rewrite ?Rabs_Rabsolu in *. rewrite (Rabs_pos_eq (x halves)) in Cd by exact H0.
  set (p := Rabs (x a_x - x at_x)) in *. set (r := Rabs (x a_y - x at_y)) in *.
  assert (p0 : 0 <= p) by apply Rabs_pos. assert (r0 : 0 <= r) by apply Rabs_pos.
  assert (P : Rabs (x s) * p + Rabs (x t) * r <= (p + r) * x halves).
  { assert (A := Rmult_le_compat_r p _ _ ltac:(lra) Hs). assert (B := Rmult_le_compat_r r _ _ ltac:(lra) Ht). lra. }
  assert (D0 : 0 <= (p + r) * x halves) by (apply Rmult_le_pos; lra).
  assert (A1 := alpha_below 1 ltac:(lia)). assert (A2 := alpha_below 2 ltac:(lia)).
  assert (A5 := alpha_below 5 ltac:(lia)). assert (A3 := alpha_below 3 ltac:(lia)). simpl INR in A1, A2, A5, A3.
  assert (Z1 := alpha_at_least 1). assert (Z2 := alpha_at_least 2). assert (Z5 := alpha_at_least 5).
  rewrite ?z, !u32_value in *.
  assert (E5 : alpha u 5 * (Rabs (x s) * p + Rabs (x t) * r) <= (1 + 1 + 1 + 1 + 1) * (1 + / 1048576) * / 16777216 *
    ((p + r) * x halves)) by (apply Rmult_le_compat; auto; apply Rplus_le_le_0_compat; apply Rmult_le_pos; auto using
      Rabs_pos).
  assert (E3 := Rmult_le_compat_r _ _ _ D0 A3).
  (* What underflow takes. *)
  assert (factor : forall a y m, 0 <= a <= 2 * / 16777216 * (1 + / 1048576) -> 0 <= y <= m -> 0 <= (1 + a) * y <= 1001 / 1000 *
    m).
  { intros a y m A Y. split; [apply Rmult_le_pos; lra | apply Rmult_le_compat; lra]. }
  assert (F1 := factor (alpha u 2) (Rabs (x s)) 34359738368 ltac:(lra) ltac:(split; [apply Rabs_pos | lra])).
  assert (F2 := factor (alpha u 2) (Rabs (x t)) 34359738368 ltac:(lra) ltac:(split; [apply Rabs_pos | lra])).
  assert (F3 := factor (alpha u 1) p 1048576 ltac:(lra) ltac:(lra)).
  assert (F4 := factor (alpha u 1) r 1048576 ltac:(lra) ltac:(lra)).
  assert (F5 := factor (alpha u 2) (p + r) 2097152 ltac:(lra) ltac:(lra)).
  assert (times : forall y m, 0 <= y <= m -> 0 <= h32 * y <= h32 * m) by (intros; split; [apply Rmult_le_pos | apply
    Rmult_le_compat_l]; lra).
  assert (G1 := times _ _ F1). assert (G2 := times _ _ F2). assert (G3 := times _ _ F3). assert (G4 := times _ _ F4).
  assert (G5 := times _ _ F5). assert (G6 := times (x halves) 34359738368 ltac:(lra)).
  assert (hh : 0 <= h32 * h32 <= h32 * / 100) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
  clear factor times F1 F2 F3 F4 F5. apply between in Cd.
  eapply Rle_trans; [exact Cv |]. lra.
Qed.

Theorem q_near v d : computed q v -> computed distance d -> Rabs (v - real x q) <= 4 / 10000000 * d + lost_of_q.
Proof. intros. now apply along_strip_near. Qed.
Theorem across_near v d : computed across v -> computed distance d -> Rabs (v - real x across) <= 4 / 10000000 * d +
  lost_of_q.
Proof. intros. now apply along_strip_near. Qed.

(* A height, against the number `highest` that is HEIGHT_NEAR more than the height's. *)
Hypothesis units_in : / 32 <= x units <= 75557863725914323419136.
Definition may_lose (i : nat) : Q := if Nat.eqb i units then 0 else h32Q.
Lemma units_are_kept : keeps x may_lose.
Proof.
  intros i. unfold may_lose. destruct (Nat.eqb_spec i units) as [-> |]; [right | now left]. split; [reflexivity |].
  right. assert (h := h32_below). simpl in h. rewrite Rabs_pos_eq; lra.
Qed.
Definition of_height := 205 / 100 * u.
Theorem height_near v m : computed height v -> Rabs v + 9 / 10 * / 65536 <= m -> Rabs (v - real x height) <= of_height * m.
Proof.
  intros C Hm. assert (K := computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near seen32_near
    x (fun i => Q2R (may_lose i)) (keeps_range x _ units_are_kept) (keeps_near x _ units_are_kept) _ v C).
  assert (A2 := alpha_below 2 ltac:(lia)). simpl INR in A2. assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  cbn -[u32 h32 alpha may_lose] in *. unfold of_product in K. replace (Q2R (may_lose units)) with 0 in K
    by (unfold may_lose; simpl; now rewrite Q2R_0').
  rewrite u32_value in *. rewrite (Rabs_pos_eq (x units)) in K by lra.
  assert (P : 0 <= x units * Rabs (x a_z - x at_z)) by (apply Rmult_le_pos; [lra | apply Rabs_pos]).
  assert (E := Rmult_le_compat_r _ _ _ P A2).
  assert (A0 : alpha u 0 = 0) by (unfold alpha; simpl; lra). rewrite A0 in K.
  assert (hu := Rmult_le_compat_r (x units) _ _ ltac:(lra) h1). unfold of_height.
  set (Y := x units * (x a_z - x at_z)) in *.
  assert (Y_is : Rabs Y = x units * Rabs (x a_z - x at_z)) by (unfold Y; rewrite Rabs_mult, (Rabs_pos_eq (x units)) by lra;
    reflexivity).
  assert (T := Rabs_triang v (Y - v)). replace (v + (Y - v)) with Y in T by ring. rewrite Rabs_minus_sym in K.
  rewrite (Rabs_minus_sym v). lra.
Qed.
End Corner.

(* ---- Slopes ---- *)

(* A computed slope s of a height v_h at v_q; H and Q are the real ones. *)
Definition of_slope := 61 / 100000000.
Lemma slope_moves s v_h v_q H Q F h S :
  0 < v_q -> 0 < S -> 0 <= F -> 0 <= h -> F * S <= 65 * v_q ->
  Rabs (v_h - H) <= 407 / 100 * u * (h * S) -> Rabs (v_q - Q) <= 54 / 100000000 * (F * S) ->
  Rabs v_h <= 1001 / 1000 * (h * S) -> Rabs (s - v_h / v_q) <= 601 / 100 * u * Rabs (v_h / v_q) + / 10 * u * (h * (S / v_q))
  -> Rabs (s - H / Q) <= of_slope * ((Rabs s * F + h) * S / v_q).
Proof.
  intros q0 S0 F0 h0 far Hh Hq large Hs. unfold of_slope. set (r := v_h / v_q) in *. set (t := S / v_q) in *.
  assert (t0 : 0 < t) by (unfold t; apply Rdiv_lt_0_compat; lra).
  assert (Ft : 0 <= F * t) by (apply Rmult_le_pos; lra). assert (ht : 0 <= h * t) by (apply Rmult_le_pos; lra).
  assert (Ft65 : F * t <= 65).
  { apply Rmult_le_reg_r with v_q; auto. replace (F * t * v_q) with (F * S) by (unfold t; field; lra). exact far. }
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
    (407 / 100 * u * (h * S) + Rabs r * (54 / 100000000 * (F * S))) * ((1 + 4 / 100000) * / v_q)).
  { apply Rmult_le_compat; auto using Rabs_pos; try lra. left. apply Rinv_0_lt_compat; lra. }
  replace ((407 / 100 * u * (h * S) + Rabs r * (54 / 100000000 * (F * S))) * ((1 + 4 / 100000) * / v_q)) with
    ((407 / 100 * u * (h * t) + 54 / 100000000 * (Rabs r * (F * t))) * (1 + 4 / 100000)) in G2
    by (unfold t; field; repeat split; lra).
  replace ((Rabs s * F + h) * S / v_q) with (Rabs s * (F * t) + h * t) by (unfold t; field; repeat split; lra).
  assert (s_size : Rabs r <= (1 + 1 / 1000000) * Rabs s + / 5 * u * (h * t)).
  { assert (r0 := Rabs_pos r). assert (U := Rabs_triang_inv r (r - s)). replace (r - (r - s)) with s in U by ring.
    rewrite Rabs_minus_sym in Hs. lra. }
  assert (G3 := Rmult_le_compat_r _ _ _ Ft s_size). assert (0 <= Rabs s * (F * t)) by (apply Rmult_le_pos; auto using
    Rabs_pos).
  assert (G4 := Rmult_le_compat_l _ _ _ ht Ft65). lra.
Qed.

Definition least_crossing : Q := 1 # 17592186044416.  (* 2^-44 *)
Definition least_corner : Q := 1 # 2305843009213693952.  (* 2^-61 *)
Definition least_height : Q := 1 # 131072.  (* 2^-17 *)
(* The product of a height and of 1 / v_q, a quotient. *)
Lemma product_near x i e s v_q h S : computes32 x (Mul (Given i 5) e) s -> x i = / v_q ->
  / 2305843009213693952 <= v_q <= 140737488355328 -> / 131072 <= h -> / 36893488147419103232 <= S -> v_q <= 1048576 * 2 * S ->
  exists v_h, computes32 x e v_h /\ (Rabs v_h <= 1001 / 1000 * (h * S) ->
    Rabs (s - v_h / v_q) <= 601 / 100 * u * Rabs (v_h / v_q) + / 10 * u * (h * (S / v_q))).
Proof.
  intros C I q_in h_in S_in qS. destruct (step32_mul _ _ _ _ C) as (p & v_h & Cp & Ch & N). exists v_h. split; [exact Ch |].
  intros large. assert (Hp : Rabs (p - / v_q) <= alpha u32 5 * Rabs (/ v_q)) by (rewrite <- I; inversion Cp; subst; assumption).
  assert (A5 := alpha_below 5 ltac:(lia)). simpl INR in A5. assert (e0 := h32_positive). assert (e1 := h32_below). simpl in e1.
  assert (i0 : 0 < / v_q) by (apply Rinv_0_lt_compat; lra). rewrite (Rabs_pos_eq (/ v_q)) in Hp by lra.
  assert (Hp' := Rmult_le_compat_r _ _ _ (Rlt_le _ _ i0) A5).
  set (r := v_h / v_q). set (w := / v_q) in *. assert (r_is : r = w * v_h) by (unfold r, w, Rdiv; ring).
  assert (P : Rabs (p * v_h - r) <= 5001 / 1000 * u * Rabs r).
  { rewrite r_is. replace (p * v_h - w * v_h) with ((p - w) * v_h) by ring. rewrite !Rabs_mult, (Rabs_pos_eq w) by lra.
    assert (G := Rmult_le_compat_r _ _ _ (Rabs_pos v_h) (Rle_trans _ _ _ Hp Hp')).
    assert (Z : 0 <= w * Rabs v_h) by (apply Rmult_le_pos; [lra | apply Rabs_pos]). lra. }
  assert (T := Rabs_triang (p * v_h - r) r). replace (p * v_h - r + r) with (p * v_h) in T by ring.
  assert (p_in : Rabs p <= 1001 / 1000 * w) by (apply between in Hp; apply Rabs_le; lra).
  set (t := S / v_q). assert (t_is : t = S * w) by reflexivity. assert (wq : w * v_q = 1) by (unfold w; field; lra).
  assert (hS : / 131072 * S <= h * S) by (apply Rmult_le_compat_r; lra).
  assert (t_least : / 2097152 <= t).
  { rewrite t_is. assert (G := Rmult_le_compat_r w _ _ ltac:(lra) qS). lra. }
  assert (ht : / 131072 * t <= h * t) by (apply Rmult_le_compat_r; lra).
  (* 2 h (|p| + |v_h| + 1) *)
  assert (L1 : h32 * w <= / 100000 * u * (h * t)).
  { assert (G := Rmult_le_compat_r w _ _ ltac:(lra) S_in). rewrite <- t_is in G.
    assert (G2 := Rmult_le_compat_r w _ _ ltac:(lra) e1). lra. }
  assert (hS_t : h * S <= 140737488355328 * (h * t)).
  { rewrite t_is. assert (G := Rmult_le_compat_r w _ _ ltac:(lra) (proj2 q_in)). rewrite (Rmult_comm v_q), wq in G.
    assert (Z : 0 <= h * S) by lra. assert (G2 := Rmult_le_compat_l _ _ _ Z G). lra. }
  assert (L2 := Rmult_le_compat_l h32 _ _ ltac:(lra) (Rle_trans _ _ _ large (Rmult_le_compat_l (1001 / 1000) _ _ ltac:(lra)
    hS_t))).
  assert (L2' := Rmult_le_compat_r (h * t) _ _ ltac:(lra) e1).
  assert (L3 := Rmult_le_compat_l h32 _ _ ltac:(lra) p_in). assert (Z := Rabs_pos r).
  replace (s - r) with ((s - p * v_h) + (p * v_h - r)) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra.
Qed.

Section Slopes.
Variable x : nat -> R.
(* The real numbers of the two corners. *)
Variables Q_i Q_j H_i H_j : R.
Hypotheses (sizes_i : 0 <= x size_i <= 33554432) (sizes_j : 0 <= x size_j <= 33554432).
Hypotheses (F_in : / 1100000000000 <= x farthest <= 1048576) (h_in : Q2R least_height <= x highest <= 1048576).
Hypotheses (q_i_near : Rabs (x q_i - Q_i) <= 4 / 10000000 * x farthest).
Hypotheses (q_j_near : Rabs (x q_j - Q_j) <= 4 / 10000000 * x farthest).
Hypotheses (h_i_near : Rabs (x height_i - H_i) <= of_height * x highest).
Hypotheses (h_j_near : Rabs (x height_j - H_j) <= of_height * x highest).
Hypotheses (h_i_in : Rabs (x height_i) <= x highest) (h_j_in : Rabs (x height_j) <= x highest).
Hypotheses (q_i_in : Rabs (x q_i) <= 1001 / 1000 * x farthest) (q_j_in : Rabs (x q_j) <= 1001 / 1000 * x farthest).
Let S := x size_i + x size_j.
Let h_least : / 131072 <= x highest.
Proof. destruct h_in as [L _]. revert L. unfold Q2R, least_height; simpl. lra. Qed.

(* A mean of two numbers, each wrong by e, times both sizes. *)
Lemma mean_near a b A B e : Rabs (a - A) <= e -> Rabs (b - B) <= e ->
  Rabs ((x size_j * a + x size_i * b) - (x size_j * A + x size_i * B)) <= e * S.
Proof.
  intros Ha Hb. replace (x size_j * a + x size_i * b - (x size_j * A + x size_i * B)) with
    (x size_j * (a - A) + x size_i * (b - B)) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult, (Rabs_pos_eq (x size_i)), (Rabs_pos_eq (x size_j)) by lra.
  assert (P := Rmult_le_compat_l _ _ _ (proj1 sizes_j) Ha). assert (Q := Rmult_le_compat_l _ _ _ (proj1 sizes_i) Hb).
  unfold S. lra.
Qed.
Lemma mean_in a b M : Rabs a <= M -> Rabs b <= M -> Rabs a * x size_j + Rabs b * x size_i <= M * S.
Proof.
  intros Ha Hb. assert (P := Rmult_le_compat_r _ _ _ (proj1 sizes_j) Ha).
  assert (Q := Rmult_le_compat_r _ _ _ (proj1 sizes_i) Hb). unfold S. lra.
Qed.

(* The computed means: the height's, and q's. *)
Definition mean_height := match slope with Mul _ m => m | _ => Const 0 end.
Lemma mean_computed a b e v M : e = Fma (Given a 0) (Given size_j 0) (Mul (Given b 0) (Given size_i 0)) ->
  Rabs (x a) <= M -> Rabs (x b) <= M -> computes32 x e v ->
  Rabs (v - (x size_j * x a + x size_i * x b)) <= 2001 / 1000 * u * (M * S) + h32 * (3 * M + 2 * S + 6).
Proof.
  intros -> Ha Hb C. apply near32 in C. unfold lost32 in C. cbn -[u32 h32 alpha] in C. unfold of_product in C.
  assert (z : alpha u32 0 = 0) by (unfold alpha; simpl; lra).
  rewrite (Rabs_pos_eq (x size_i)), (Rabs_pos_eq (x size_j)) in C by lra.
  assert (A := alpha_below 2 ltac:(lia)). simpl INR in A. assert (P := mean_in _ _ M Ha Hb).
  assert (Z := alpha_at_least 2). rewrite ?z, !u32_value in *. assert (h := h32_positive). assert (h1 := h32_below).
  simpl in h1.
  assert (P0 : 0 <= Rabs (x a) * x size_j + Rabs (x b) * x size_i).
  { apply Rplus_le_le_0_compat; apply Rmult_le_pos; auto using Rabs_pos; lra. }
  assert (E := Rmult_le_compat _ _ _ _ Z P0 A P).
  assert (ha := Rmult_le_compat_l h32 _ _ ltac:(lra) Ha). assert (hb := Rmult_le_compat_l h32 _ _ ltac:(lra) Hb).
  assert (hi : 0 <= h32 * x size_i) by (apply Rmult_le_pos; lra). assert (hj : 0 <= h32 * x size_j) by (apply Rmult_le_pos;
    lra).
  assert (hM : 0 <= h32 * M) by (apply Rmult_le_pos; [lra | eapply Rle_trans; [apply Rabs_pos | exact Ha]]).
  assert (hh : 0 <= h32 * h32 <= h32 * / 100) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
  replace (x size_j * x a + x size_i * x b) with (x a * x size_j + x b * x size_i) by ring.
  eapply Rle_trans; [exact C |]. unfold S in *. lra.
Qed.

(* v_q is the computed mean, s the computed slope. *)
Theorem between_near v_q s :
  computes32 x q_between v_q -> computes32 x slope s -> x quotient_1 = / v_q -> Q2R least_crossing <= v_q ->
  x farthest * S <= 65 * v_q ->
  Rabs (s - (x size_j * H_i + x size_i * H_j) / (x size_j * Q_i + x size_i * Q_j)) <=
  of_slope * ((Rabs s * x farthest + x highest) * S / v_q).
Proof.
  intros Cq Cs I q_least far. assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  replace (Q2R least_crossing) with (/ 17592186044416) in q_least by (unfold Q2R, least_crossing; simpl; lra).
  assert (S_in : 0 <= S <= 67108864) by (unfold S; lra).
  assert (hS : 0 <= x highest * S) by (apply Rmult_le_pos; lra).
  assert (FS : 0 <= x farthest * S) by (apply Rmult_le_pos; lra).
  assert (FS_in : x farthest * S <= 1048576 * S) by (apply Rmult_le_compat_r; lra).
  assert (Nq := mean_computed _ _ _ _ _ eq_refl q_i_in q_j_in Cq).
  assert (Mq := mean_near _ _ _ _ _ q_i_near q_j_near). assert (Mh := mean_near _ _ _ _ _ h_i_near h_j_near).
  assert (hF : h32 * (3 * (1001 / 1000 * x farthest) + 2 * S + 6) <= h32 * 1000000000) by (apply Rmult_le_compat_l; lra).
  assert (I2 := mean_in _ _ _ q_i_in q_j_in).
  assert (Tq := Rabs_triang (x size_j * x q_i) (x size_i * x q_j)).
  rewrite !Rabs_mult, (Rabs_pos_eq (x size_i)), (Rabs_pos_eq (x size_j)) in Tq by lra.
  assert (Uq := Rabs_triang_inv v_q (x size_j * x q_i + x size_i * x q_j)).
  assert (v_q_in : v_q <= 1002 / 1000 * (x farthest * S)).
  { rewrite (Rabs_pos_eq v_q) in Uq by lra. lra. }
  assert (S_least : / 36893488147419103232 <= S) by lra.
  destruct (product_near x quotient_1 mean_height s v_q (x highest) S Cs I ltac:(lra) h_least S_least ltac:(lra)) as (v_h & Ch &
    Hs).
  assert (Nh := mean_computed _ _ _ _ _ eq_refl h_i_in h_j_in Ch).
  assert (hh : h32 * (3 * x highest + 2 * S + 6) <= / 100 * u * (x highest * S)).
  { assert (G1 := Rmult_le_compat_l (x highest) _ _ ltac:(lra) S_least).
    assert (G2 := Rmult_le_compat_r S _ _ ltac:(lra) h_least).
    assert (G3 := Rmult_le_compat_r (x highest) _ _ ltac:(lra) h1). assert (G4 := Rmult_le_compat_r S _ _ ltac:(lra) h1). lra. }
  assert (large : Rabs v_h <= 1001 / 1000 * (x highest * S)).
  { assert (I3 := mean_in _ _ _ h_i_in h_j_in).
    assert (T := Rabs_triang (x size_j * x height_i) (x size_i * x height_j)).
    rewrite !Rabs_mult, (Rabs_pos_eq (x size_i)), (Rabs_pos_eq (x size_j)) in T by lra.
    assert (U := Rabs_triang (v_h - (x size_j * x height_i + x size_i * x height_j))
      (x size_j * x height_i + x size_i * x height_j)).
    replace (v_h - (x size_j * x height_i + x size_i * x height_j) + (x size_j * x height_i + x size_i * x height_j))
      with v_h in U by ring. lra. }
  unfold of_height in Mh.
  apply slope_moves with (v_h := v_h) (v_q := v_q); auto; try lra.
  - apply between in Nh. apply between in Mh. apply Rabs_le. lra.
  - apply between in Nq. apply between in Mq. apply Rabs_le. lra.
Qed.

(* d: the corner's own distance. *)
Theorem corner_near s d :
  Rabs (x q_i - Q_i) <= 4 / 10000000 * d + lost_of_q -> 0 <= d <= x farthest -> d <= 64 * x q_i ->
  Q2R least_corner <= x q_i <= 101 / 100 * d -> computes32 x corner s -> x quotient_2 = / x q_i ->
  Rabs (s - H_i / Q_i) <= of_slope * ((Rabs s * x farthest + x highest) * 1 / x q_i).
Proof.
  intros Hq [d0 Hd] far q_in Cs I.
  replace (Q2R least_corner) with (/ 2305843009213693952) in q_in by (unfold Q2R, least_corner; simpl; lra).
  destruct (product_near x quotient_2 (Given height_i 0) s (x q_i) (x highest) 1 Cs I ltac:(lra) h_least ltac:(lra) ltac:(lra))
    as (v_h & Ch & Hs). apply given32_is in Ch. subst v_h. unfold of_height in h_i_near.
  eapply Rle_trans; [apply slope_moves with (v_h := x height_i) (v_q := x q_i) (F := d) (h := x highest) (S := 1);
    auto; try lra; apply Hs; lra |].
  - assert (J := Rinv_0_lt_compat (x q_i) ltac:(lra)). assert (P := Rmult_le_compat_l _ _ _ (Rabs_pos s) Hd).
    assert (G : (Rabs s * d + x highest) * 1 / x q_i <= (Rabs s * x farthest + x highest) * 1 / x q_i).
    { unfold Rdiv. apply Rmult_le_compat_r; lra. }
    unfold of_slope. lra.
Qed.
End Slopes.

(* The kernel's bounds have only positive terms and one quotient, off by 5 roundings, which they are multiplied with;
   none of their products underflows: `highest` times SLOPE_ERROR and both sizes is above 2^-103, and over q above 2^-59. *)
Definition slope_error : Q := match corner_bound with Mul _ (Times c _) => c | _ => 0%Q end.
Lemma error_is : slope_bound =
  Mul (Given quotient_1 5) (Mul (Fma (Abs slope) (Given farthest 0) (Given highest 0))
                                (Times slope_error (Add (Given size_i 0) (Given size_j 0)))).
Proof. reflexivity. Qed.
(* `slope` is a number of the bound, not one of its roundings. *)
Definition least_error := Eval vm_compute in
  ((61 # 100000000) / (1 - alphaQ u32Q (roundings slope_bound - roundings slope)))%Q.

(* ---- Lights ---- *)
Definition least_rise : Q := 1 # 19342813113834066795298816.  (* 2^-84 *)
Lemma lights_are_normal U L r : / 32 <= U -> 0 < L <= 34359738368 -> Q2R least_rise <= r -> 2 * h32 <= r * U / L.
Proof.
  intros U_in [L0 L1] R. assert (h1 := h32_below). simpl in h1.
  replace (Q2R least_rise) with (/ 19342813113834066795298816) in R by (unfold Q2R, least_rise; simpl; lra).
  assert (I : / 34359738368 <= / L) by (apply Rinv_le_contravar; lra).
  assert (P := Rmult_le_compat (/ 19342813113834066795298816) r (/ 32) U ltac:(lra) ltac:(lra) R U_in).
  assert (P2 := Rmult_le_compat (/ 19342813113834066795298816 * / 32) (r * U) (/ 34359738368) (/ L) ltac:(lra) ltac:(lra) P I).
  unfold Rdiv. lra.
Qed.

(* ---- The height over the point ---- *)
Section Over.
Variable x : nat -> R.
Variables A B C H I J : R.  (* the real areas and heights *)
Let F := x farthest * x farthest.
Hypotheses (F_in : / 1100000000000 <= x farthest <= 1048576) (h_in : Q2R least_height <= x highest).
Let right_area i a := Rabs (x i - a) <= / 524288 * F /\ Rabs (x i) <= 201 / 100 * F.
Let right_height i h := Rabs (x i - h) <= of_height * x highest /\ Rabs (x i) <= x highest.
Hypotheses (a_x : right_area areas_x A) (a_y : right_area areas_y B) (a_z : right_area areas_z C).
Hypotheses (h_i : right_height height_i H) (h_j : right_height height_j I) (h_k : right_height height_k J).

Lemma term_near i a j h : right_area i a -> right_height j h -> 0 <= x highest ->
  Rabs (x i * x j - a * h) <= (/ 524288 + 413 / 100 * u) * (F * x highest) /\
  Rabs (x i) * Rabs (x j) <= 201 / 100 * (F * x highest).
Proof.
  intros [Na Ia] [Nh Ih] h0. unfold of_height in Nh. assert (f0 : 0 <= F) by (unfold F; apply Rmult_le_pos; lra). split.
  - assert (size : Rabs h <= 10001 / 10000 * x highest).
    { assert (T := Rabs_triang (x j) (h - x j)). replace (x j + (h - x j)) with h in T by ring.
      rewrite Rabs_minus_sym in Nh. lra. }
    replace (x i * x j - a * h) with (x i * (x j - h) + (x i - a) * h) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult.
    assert (P := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Ia Nh).
    assert (Q := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Na size).
    assert (0 <= F * x highest) by (apply Rmult_le_pos; lra). lra.
  - rewrite <- Rmult_assoc. apply Rmult_le_compat; auto using Rabs_pos.
Qed.

(* 2^-17 less the bound's own roundings. *)
Theorem over_near v : computes32 x over v -> Rabs (v - (A * H + B * I + C * J)) <= 1271 / 10 * u * (F * x highest).
Proof.
  intros Cv. assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  assert (h_least : / 131072 <= x highest) by (revert h_in; unfold Q2R, least_height; simpl; lra).
  apply near32 in Cv. unfold lost32 in Cv. cbn -[u32 h32 alpha Q2R] in Cv. unfold of_product in Cv.
  assert (z : alpha u32 0 = 0) by (unfold alpha; simpl; lra).
  replace (Q2R (0 # 1)) with 0 in Cv by (unfold Q2R; simpl; lra). rewrite Rabs_R0 in Cv.
  assert (h0 : 0 <= x highest) by lra.
  destruct (term_near _ _ _ _ a_x h_i h0) as [N1 I1]. destruct (term_near _ _ _ _ a_y h_j h0) as [N2 I2].
  destruct (term_near _ _ _ _ a_z h_k h0) as [N3 I3].
  assert (A3 := alpha_below 3 ltac:(lia)). simpl INR in A3. assert (Z := alpha_at_least 3). rewrite ?z, !u32_value in *.
  set (P := Rabs (x areas_z) * Rabs (x height_k) + (Rabs (x areas_y) * Rabs (x height_j) +
    (Rabs (x areas_x) * Rabs (x height_i) + 0))) in *.
  assert (P0 : 0 <= P).
  { unfold P. assert (W := fun i j => Rmult_le_pos _ _ (Rabs_pos (x i)) (Rabs_pos (x j))).
    assert (W1 := W areas_x height_i). assert (W2 := W areas_y height_j). assert (W3 := W areas_z height_k). lra. }
  assert (P1 : P <= 603 / 100 * (F * x highest)) by (unfold P; lra).
  assert (E := Rmult_le_compat _ _ _ _ Z P0 A3 P1).
  (* What underflow takes: of areas by heights, and of heights by areas. *)
  assert (F_least : / 1100000000000 * / 1100000000000 <= F) by (unfold F; apply Rmult_le_compat; lra).
  assert (FH := Rmult_le_compat_r _ _ _ h0 F_least). assert (HF := Rmult_le_compat_l F _ _ ltac:(lra) h_least).
  assert (times : forall y m, Rabs y <= m -> 0 <= h32 * Rabs y <= h32 * m) by (intros; split; [apply Rmult_le_pos; [lra |
    apply Rabs_pos] | apply Rmult_le_compat_l; lra]).
  assert (L1 := times _ _ (proj2 a_x)). assert (L2 := times _ _ (proj2 a_y)). assert (L3 := times _ _ (proj2 a_z)).
  assert (L4 := times _ _ (proj2 h_i)). assert (L5 := times _ _ (proj2 h_j)). assert (L6 := times _ _ (proj2 h_k)).
  assert (hF : h32 * F <= / 1000000 * u * (F * x highest)).
  { assert (G := Rmult_le_compat_r F _ _ ltac:(lra) h1). lra. }
  assert (hH : h32 * x highest <= / 1000000 * u * (F * x highest)).
  { assert (G := Rmult_le_compat_r (x highest) _ _ h0 h1). lra. }
  assert (hh : 0 <= h32 * h32 <= h32 * / 100) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
  assert (h_only : h32 <= 4 / 100 * u * (F * x highest)) by lra.
  apply between in N1. apply between in N2. apply between in N3. apply between in Cv. apply Rabs_le. lra.
Qed.
End Over.
Definition over_error : Q := match over_bound with Mul _ (Mul _ (Times c _)) => c | _ => 0%Q end.
Definition least_over := Eval vm_compute in ((1271 # 10) * (1 # 2 ^ 24) / (1 - alphaQ u32Q (roundings over_bound)))%Q.

Definition near_height : Q := match highest_of with Add _ (Const c) => c | _ => 0%Q end.
Lemma kernels_are_enough : (least_crossing <= value_of least_of_crossing * (1 - 2 * u32Q) /\
  least_corner <= value_of least_of_corner * (1 - u32Q) /\ least_height <= (9 # 10) * near_height /\
  least_rise <= least_constant)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_error slope_error.
Print constants.
Definition rests := Eval vm_compute in shown least_over over_error.
Print rests.
Definition others := Eval vm_compute in shown least_rise least_constant.
Print others.
Definition checked :=
  (q_near, across_near, height_near, between_near, corner_near, over_near, lights_are_normal, kernels_are_enough).
Print Assumptions checked.
