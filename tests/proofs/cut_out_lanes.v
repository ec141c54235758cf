(* SPDX-License-Identifier: MIT *)
(* cut_outs.clh, lanes_texels(): a texture coordinate of one of many hits, in texels, from the float level's e; and
   cut_out_coordinate() without double precision (docs/numerics.md, 15). Both have the same quotients and products.
     lost_near       what the e and their sum are off by, as computed;
     quotient_near   the quotient of what is computed;
     texel_near      the coordinate in texels;
     alpha_near      the corners' alpha;
     one_is_between  of a single hit, less 1/2: it lies between the computed coordinate less and plus its error, rounded.

   Assumed: each e is off by at most its bound less 4 % (det3_float.v has 4.8 %), the real ones have one sign and their
     sum is
   not 0 (the ray meets the triangle); a bound is 2^-61 at least (no Q below 2^-40 has one); no corner's coordinate exceeds
   greater_4; a side has up to 2^24 texels (CUT_OUT_LARGEST_SIDE: 2^15); a quotient is off by 2.5 ulp and by 2^-126. Denormals may be kept or flushed: what
   that takes, 2^-37 texels, is a part of the 4 u that the kernel adds. A greater of two is at least both.
   In prose: what a texel's class does with a coordinate that is
   certain to half a texel. Overflow: coordinates are below 2^20 texels, e at most 2^66. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition e_a := 0%nat.
Definition e_b := 1%nat.
Definition e_c := 2%nat.
Definition bound_a := 3%nat.
Definition bound_b := 4%nat.
Definition bound_c := 5%nat.
Definition u_x := 6%nat.
Definition u_y := 7%nat.
Definition u_z := 8%nat.
Definition v_x := 9%nat.
Definition v_y := 10%nat.
Definition v_z := 11%nat.
Definition width := 12%nat.
Definition height := 13%nat.
Definition quotient_1 := 14%nat.
Definition greater_1 := 15%nat.
Definition greater_2 := 16%nat.
Definition greater_3 := 17%nat.
Definition greater_4 := 18%nat.
Definition greater_5 := 19%nat.
Definition quotient_2 := 20%nat.
Definition sum :=
  Add (Add (Given e_a 0) (Given e_b 0)) (Given e_c 0).
Definition lost :=
  Add (Add (Add (Given bound_a 0) (Given bound_b 0)) (Given bound_c 0)) (Times (1 # 4194304) (Add (Abs (Given e_c
    0)) (Add (Abs (Given e_a 0)) (Abs (Given e_b 0))))).
Definition quotient_1_over :=
  Add (Add (Mul (Given e_a 0) (Given u_x 0)) (Mul (Given e_b 0) (Given u_y 0))) (Mul (Given e_c 0) (Given u_z 0)).
Definition quotient_1_under :=
  sum.
Definition texel :=
  Mul (Given quotient_1 5) (Given width 0).
Definition greater_1_one :=
  Abs (Given v_y 0).
Definition greater_1_other :=
  Abs (Given v_z 0).
Definition greater_2_one :=
  Abs (Given v_x 0).
Definition greater_2_other := Given greater_1 0.
Definition greater_3_one :=
  Abs (Given u_y 0).
Definition greater_3_other :=
  Abs (Given u_z 0).
Definition greater_4_one :=
  Abs (Given u_x 0).
Definition greater_4_other := Given greater_3 0.
Definition greater_5_one :=
  Mul (Given height 0) (Given greater_2 0).
Definition greater_5_other :=
  Mul (Given width 0) (Given greater_4 0).
(* quotient_2_over = quotient_2_over_constant * lost *)
Definition quotient_2_over_constant : Q := 2 # 1.
Definition quotient_2_under :=
  Abs quotient_1_under.
Definition error :=
  Mul (Given greater_5 0) (Times (4404019 # 4194304) (Add (Const (1 # 1048576)) (Given quotient_2 5))).
Definition error_rest : Q := 1 # 4194304.
Definition of_one :=
  texel.
Definition of_one_rest : Q := -1 # 2.
Definition error_of_one :=
  Mul (Given width 0) (Mul (Given greater_4 0) (Times (4404019 # 4194304) (Add (Const (1 # 1048576)) (Given
    quotient_2 5)))).
Definition error_of_one_rest : Q := 1 # 8388608.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Definition top := quotient_1_over.

Section Hit.
Variable x : nat -> R.
Local Notation computed := (computes32 x).
Variables E_a E_b E_c U : R.  (* the real barycentric coordinates, and the hit's coordinate *)
Let near_e e E b := Rabs (x e - E) <= 96 / 100 * x b.
Hypotheses (a_near : near_e e_a E_a bound_a) (b_near : near_e e_b E_b bound_b) (c_near : near_e e_c E_c bound_c).
Let M := x greater_4.
Hypotheses (u_x_in : Rabs (x u_x) <= M) (u_y_in : Rabs (x u_y) <= M) (u_z_in : Rabs (x u_z) <= M) (U_in : Rabs U <= M).
Hypothesis U_is : U * (E_a + E_b + E_c) = E_a * x u_x + E_b * x u_y + E_c * x u_z.
Let S := Rabs (x e_a) + Rabs (x e_b) + Rabs (x e_c).
Let B := x bound_a + x bound_b + x bound_c.
Let usable_bound b := / 2305843009213693952 <= x b.  (* 2^-61 *)
Hypotheses (a_usable : usable_bound bound_a) (b_usable : usable_bound bound_b) (c_usable : usable_bound bound_c).

Lemma M0 : 0 <= M.
Proof. eapply Rle_trans; [apply Rabs_pos | exact U_in]. Qed.
Lemma S0 : 0 <= S.
Proof. unfold S. repeat apply Rplus_le_le_0_compat; apply Rabs_pos. Qed.
Lemma b0 : 0 <= x bound_a /\ 0 <= x bound_b /\ 0 <= x bound_c.
Proof. repeat split; [assert (H := Rle_trans _ _ _ (Rabs_pos _) a_near) | assert (H := Rle_trans _ _ _ (Rabs_pos _)
  b_near) |
  assert (H := Rle_trans _ _ _ (Rabs_pos _) c_near)]; lra. Qed.

Theorem lost_near l : computed lost l -> 999 / 1000 * (B + 4 * u * S) <= l.
Proof.
  intros C. apply near32 in C. destruct b0 as (b1 & b2 & b3). assert (s0 := S0). unfold S, B, usable_bound in *.
  assert (A := alpha_below (roundings lost) ltac:(vm_compute; lia)). cbn [roundings lost max Nat.max] in A.
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1. unfold lost32 in C.
  cbn -[u32 h32 alpha Q2R] in C. rewrite !(Rabs_pos_eq (Q2R _)), (Rabs_pos_eq (x bound_a)), (Rabs_pos_eq (x bound_b)),
    (Rabs_pos_eq (x bound_c)) in C
    by (try (unfold Q2R; simpl); lra). rewrite !u32_value in C. rewrite u32_value in A.
  replace (Q2R (1 # 4194304)) with (4 * u) in C by (unfold Q2R; simpl; lra). simpl INR in A.
  set (P := x bound_a + x bound_b + x bound_c + 4 * u * (Rabs (x e_c) + (Rabs (x e_a) + Rabs (x e_b)))) in *.
  assert (E := Rmult_le_compat_r P _ _ ltac:(unfold P; lra) A). apply between in C. unfold P in *. lra.
Qed.

Lemma sum_near s : computed sum s -> Rabs (s - (E_a + E_b + E_c)) <= 961 / 1000 * B + 201 / 100 * u * S.
Proof.
  intros C. apply near32 in C. unfold lost32 in C. cbn -[u32 h32 alpha] in C. rewrite !u32_value in C.
  assert (A := alpha_below 2 ltac:(lia)). simpl INR in A. rewrite u32_value in A.
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  assert (P := Rmult_le_compat_r _ _ _ S0 A). unfold S, B, near_e, usable_bound in *.
  apply between in C. apply between in a_near. apply between in b_near. apply between in c_near. apply Rabs_le. lra.
Qed.
(* What underflow takes of the products. *)
Let tiny_top := 2 * h32 * S + 20 * h32.
Lemma top_near t : computed top t -> Rabs (t - U * (E_a + E_b + E_c)) <= M * (961 / 1000 * B + 301 / 100 * u * S) +
  tiny_top.
Proof.
  intros C. apply near32 in C. unfold lost32 in C. cbn -[u32 h32 alpha] in C. unfold of_product in C.
  assert (A := alpha_below 3 ltac:(lia)). simpl INR in A. assert (z : alpha u32 0 = 0) by (unfold alpha; simpl; lra).
  rewrite ?z, !u32_value in C. rewrite u32_value in A.
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  assert (m0 := M0). assert (s0 := S0). destruct b0 as (b1 & b2 & b3).
  assert (P : Rabs (x e_a) * Rabs (x u_x) + Rabs (x e_b) * Rabs (x u_y) + Rabs (x e_c) * Rabs (x u_z) <= S * M).
  { assert (times : forall i j, Rabs (x j) <= M -> Rabs (x i) * Rabs (x j) <= Rabs (x i) * M).
    { intros. apply Rmult_le_compat_l; auto using Rabs_pos. }
    assert (T1 := times e_a _ u_x_in). assert (T2 := times e_b _ u_y_in). assert (T3 := times e_c _ u_z_in). unfold S.
    lra. }
  assert (P0 : 0 <= Rabs (x e_a) * Rabs (x u_x) + Rabs (x e_b) * Rabs (x u_y) + Rabs (x e_c) * Rabs (x u_z)).
  { repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos. }
  assert (Al := alpha_at_least 3). rewrite u32_value in Al. assert (G := Rmult_le_compat _ _ _ _ Al P0 A P).
  assert (moves : forall e E b j, near_e e E b -> Rabs (x j) <= M -> Rabs (x e * x j - E * x j) <= 96 / 100 * x b * M).
  { intros e E b j He Hj. replace (x e * x j - E * x j) with ((x e - E) * x j) by ring. rewrite Rabs_mult.
    apply Rmult_le_compat; auto using Rabs_pos. }
  assert (V1 := moves _ _ _ _ a_near u_x_in). assert (V2 := moves _ _ _ _ b_near u_y_in).
  assert (V3 := moves _ _ _ _ c_near u_z_in). rewrite U_is.
  assert (SM : 0 <= S * M) by (apply Rmult_le_pos; lra). unfold B, tiny_top.
  assert (lm := fun j (H : Rabs (x j) <= M) => Rmult_le_compat_l h32 _ _ ltac:(lra) H).
  assert (L1 := lm _ u_x_in). assert (L2 := lm _ u_y_in). assert (L3 := lm _ u_z_in). clear lm.
  assert (hM : h32 * M <= / 10000000000 * (x bound_a * M)).
  { assert (hb : h32 <= / 10000000000 * x bound_a) by (unfold usable_bound in *; lra).
    assert (Z := Rmult_le_compat_r M _ _ m0 hb). lra. }
  assert (bM : 0 <= x bound_a * M) by (apply Rmult_le_pos; lra).
  assert (cM : 0 <= x bound_b * M) by (apply Rmult_le_pos; lra).
  assert (dM : 0 <= x bound_c * M) by (apply Rmult_le_pos; lra).
  assert (hh : h32 * h32 <= h32 * / 100) by (apply Rmult_le_compat_l; lra).
  assert (s_is : h32 * S = h32 * Rabs (x e_a) + h32 * Rabs (x e_b) + h32 * Rabs (x e_c)) by (unfold S; ring).
  assert (hS0 := fun i => Rmult_le_pos _ _ (Rlt_le _ _ h) (Rabs_pos (x i))). assert (q1 := hS0 e_a). assert (q2 := hS0 e_b).
  assert (q3 := hS0 e_c). clear hS0.
  apply between in C. apply between in V1. apply between in V2. apply between in V3. apply Rabs_le. lra.
Qed.

(* What the kernel divides by the sum, in real numbers. *)
Let D s := 2 * (B + 4 * u * S) / Rabs s.
Local Notation lost_texels := (/ 4611686018427387904).  (* 2^-62 *)
Theorem quotient_near s t : computed sum s -> computed top t -> s <> 0 -> D s <= 501 / 1000 ->
  Rabs (t / s - U) <= M * (97 / 100 * D s) + lost_texels.
Proof.
  intros Cs Ct s0 usable. assert (Ns := sum_near _ Cs). assert (Nt := top_near _ Ct). assert (m0 := M0).
  assert (p0 := S0). assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  destruct b0 as (b1 & b2 & b3). assert (B0 : 0 <= B) by (unfold B; lra). assert (s1 := Rabs_pos_lt _ s0).
  replace (t / s - U) with (((t - U * (E_a + E_b + E_c)) + - (U * (s - (E_a + E_b + E_c)))) * / s) by (field; auto).
  rewrite Rabs_mult, Rabs_inv. assert (I := Rinv_0_lt_compat _ s1).
  assert (least : 2 * (B + 4 * u * S) <= 501 / 1000 * Rabs s).
  { assert (G := Rmult_le_compat_r _ _ _ (Rlt_le _ _ s1) usable). unfold D, Rdiv in G.
    rewrite Rmult_assoc, Rinv_l, Rmult_1_r in G by lra. exact G. }
  assert (few : tiny_top <= lost_texels * Rabs s).
  { unfold tiny_top. unfold B, usable_bound in *. assert (S_in : S <= 2200000 * Rabs s) by lra.
    assert (hS := Rmult_le_compat_l h32 _ _ ltac:(lra) S_in).
    assert (hs := Rmult_le_compat_r (Rabs s) _ _ (Rlt_le _ _ s1) h1). lra. }
  replace (M * (97 / 100 * D s) + lost_texels) with ((M * (97 / 50 * (B + 4 * u * S)) + lost_texels * Rabs s) * / Rabs s)
    by (unfold D; field; lra).
  apply Rmult_le_compat_r; [lra |].
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, Rabs_mult.
  assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) U_in Ns).
  assert (MB : 0 <= M * B) by (apply Rmult_le_pos; auto). assert (MS : 0 <= M * (u * S)) by (apply Rmult_le_pos; [| apply
    Rmult_le_pos]; lra). lra.
Qed.

(* The quotient is off by 5 roundings, then the product by one. *)
Definition least_term : Q := 91 # 167772160.
Definition least_rest : Q := 1 # 137438953472.  (* 2^-37 *)
Hypothesis width_in : 1 <= x width <= 16777216.
Theorem texel_near s t v : computed sum s -> computed top t -> s <> 0 -> Rabs (x quotient_1 - t / s) <= h32 ->
  D s <= 501 / 1000 -> computed texel v ->
  Rabs (v - U * x width) <= x width * M * (98 / 100 * D s + Q2R least_term) + Q2R least_rest.
Proof.
  intros Cs Ct s0 quotient usable C. assert (N := quotient_near _ _ Cs Ct s0 usable). assert (m0 := M0).
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  apply near32 in C. unfold lost32 in C. cbn -[u32 h32 alpha] in C. unfold of_product in C.
  rewrite (Rabs_pos_eq (x width)) in C by lra.
  assert (z : alpha u32 0 = 0) by (unfold alpha; simpl; lra). assert (A := alpha_below 6 ltac:(lia)). simpl INR in A.
  assert (A5 := alpha_below 5 ltac:(lia)). simpl INR in A5. assert (Z5 := alpha_at_least 5).
  assert (Z6 := alpha_at_least 6). rewrite ?z in C. rewrite !u32_value in C, A, A5, Z5, Z6.
  destruct b0 as (b1 & b2 & b3). assert (s1 := Rabs_pos_lt _ s0).
  assert (D0 : 0 <= D s).
  { unfold D, Rdiv. apply Rmult_le_pos; [unfold B; assert (p0 := S0); lra | left; apply Rinv_0_lt_compat, s1]. }
  assert (MD : M * D s <= M * (501 / 1000)) by (apply Rmult_le_compat_l; auto).
  set (q := x quotient_1) in *.
  assert (near_q : Rabs (q - U) <= M * (97 / 100 * D s) + lost_texels + h32).
  { replace (q - U) with ((q - t / s) + (t / s - U)) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra. }
  assert (size : Rabs q <= 1499 / 1000 * M + / 1000000000000000000).
  { replace q with ((q - U) + U) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra. }
  assert (sizes := Rmult_le_compat_r (x width) _ _ ltac:(lra) size).
  assert (Q0 : 0 <= Rabs q * x width) by (apply Rmult_le_pos; auto using Rabs_pos; lra).
  assert (G := Rmult_le_compat _ _ _ _ Z6 Q0 A sizes).
  replace (v - U * x width) with ((v - q * x width) + (q - U) * x width) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_mult, (Rabs_pos_eq (x width)) by lra.
  assert (G2 := Rmult_le_compat_r (x width) _ _ ltac:(lra) near_q).
  replace (Q2R least_term) with (91 / 10 * u) by (unfold Q2R, least_term; simpl; lra).
  replace (Q2R least_rest) with (/ 137438953472) by (unfold Q2R, least_rest; simpl; lra).
  assert (MW0 := Rmult_le_compat_l M _ _ m0 (proj1 width_in)).
  assert (MW : 0 <= M * x width) by lra.
  assert (MWD : 0 <= M * x width * D s) by (apply Rmult_le_pos; auto).
  (* What underflow takes of the product. *)
  assert (hw := Rmult_le_compat_l h32 _ _ ltac:(lra) (proj2 width_in)).
  assert (hq : 0 <= (1 + alpha u 5) * Rabs q * h32 <= 2 * (1499 / 1000 * M + / 1000000000000000000) * h32).
  { split; [repeat apply Rmult_le_pos; try apply Rabs_pos; lra |]. apply Rmult_le_compat_r; [lra |].
    apply Rmult_le_compat; try apply Rabs_pos; lra. }
  assert (hMW : h32 * (M * x width) <= / 1000000000000000000 * (M * x width)) by (apply Rmult_le_compat_r; lra).
  assert (hM : h32 * M <= h32 * (M * x width)) by (apply Rmult_le_compat_l; lra).
  assert (hh : 0 <= h32 * h32 <= h32 * / 100) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra). lra.
Qed.

(* The corners' alpha at a single hit: a quotient alone, of which 2^-52 is left (cut_out_means_float.v). *)
Theorem alpha_near s t v : computed sum s -> computed top t -> s <> 0 -> Rabs (x quotient_1 - t / s) <= h32 ->
  D s <= 501 / 1000 -> computed (Given quotient_1 5) v ->
  Rabs (v - U) <= M * (D s + Q2R least_term) + / 1152921504606846976.
Proof.
  intros Cs Ct s0 quotient usable C. assert (N := quotient_near _ _ Cs Ct s0 usable). assert (m0 := M0).
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  apply near32 in C. unfold lost32 in C. cbn -[u32 h32 alpha] in C. assert (A := alpha_below 5 ltac:(lia)). simpl INR in A.
  assert (MD := Rmult_le_compat_l _ _ _ m0 usable). set (q := x quotient_1) in *.
  assert (near_q : Rabs (q - U) <= M * (97 / 100 * D s) + lost_texels + h32).
  { replace (q - U) with ((q - t / s) + (t / s - U)) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra. }
  assert (size : Rabs q <= 1499 / 1000 * M + 2 * lost_texels).
  { replace q with ((q - U) + U) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra. }
  assert (G := Rmult_le_compat _ _ _ _ (alpha_at_least 5) (Rabs_pos q) A size).
  replace (Q2R least_term) with (91 / 10 * u) by (unfold Q2R, least_term; simpl; lra). destruct b0 as (b1 & b2 & b3).
  assert (MD0 : 0 <= M * D s).
  { apply Rmult_le_pos; auto. unfold D, Rdiv. apply Rmult_le_pos; [unfold B; assert (p0 := S0); lra |].
    left. apply Rinv_0_lt_compat, Rabs_pos_lt, s0. }
  replace (v - U) with ((v - q) + (q - U)) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra.
Qed.

(* A single hit: 1/2 is subtracted, then the error is subtracted from that and added to it, with a rounding each. *)
Definition least_of_one : Q := 123 # 167772160.
Definition least_rest_of_one : Q := 12 # 167772160.
Theorem one_is_between s t v r e l k : computed sum s -> computed top t -> s <> 0 ->
  Rabs (x quotient_1 - t / s) <= h32 -> D s <= 501 / 1000 -> computed texel v ->
  Rabs (r - (v - / 2)) <= u * Rabs (v - / 2) + 4 * h32 ->
  x width * M * (D s + Q2R least_of_one) + Q2R least_rest_of_one <= e ->
  Rabs (l - (r - e)) <= u * Rabs (r - e) + 4 * h32 -> Rabs (k - (r + e)) <= u * Rabs (r + e) + 4 * h32 ->
  l <= U * x width - / 2 <= k.
Proof.
  intros Cs Ct s0 quotient usable C Hr He Hl Hk. assert (N := texel_near _ _ _ Cs Ct s0 quotient usable C).
  replace (Q2R least_term) with (91 / 10 * u) in N by (unfold Q2R, least_term; simpl; lra).
  replace (Q2R least_rest) with (/ 137438953472) in N by (unfold Q2R, least_rest; simpl; lra).
  replace (Q2R least_of_one) with (123 / 10 * u) in He by (unfold Q2R, least_of_one; simpl; lra).
  replace (Q2R least_rest_of_one) with (12 / 10 * u) in He by (unfold Q2R, least_rest_of_one; simpl; lra).
  assert (m0 := M0). assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  assert (W0 : 0 <= x width * M) by (apply Rmult_le_pos; lra). destruct b0 as (b1 & b2 & b3).
  assert (D0 : 0 <= D s).
  { unfold D, Rdiv. apply Rmult_le_pos; [unfold B; assert (p0 := S0); lra | left; apply Rinv_0_lt_compat, Rabs_pos_lt, s0]. }
  assert (WD0 : 0 <= x width * M * D s) by (apply Rmult_le_pos; auto).
  assert (WD := Rmult_le_compat_l _ _ _ W0 usable).
  assert (UW : Rabs (U * x width) <= x width * M).
  { rewrite Rabs_mult, (Rabs_pos_eq (x width)), Rmult_comm by lra. apply Rmult_le_compat_l; lra. }
  apply between in N, UW. set (W := x width * M) in *. set (T := U * x width) in *.
  assert (v_in : Rabs (v - / 2) <= 15 / 10 * W + 51 / 100) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ Hr) in v_in. apply between in v_in.
  assert (r_in : Rabs (r - e) <= 151 / 100 * W + 52 / 100 + e /\ Rabs (r + e) <= 151 / 100 * W + 52 / 100 + e)
    by (split; apply Rabs_le; lra).
  destruct r_in as [r_l r_k]. apply (at_most32 _ _ _ _ Hl) in r_l. apply (at_most32 _ _ _ _ Hk) in r_k.
  apply between in r_l, r_k. lra.
Qed.
End Hit.

(* The kernel's error has the same form, times 1.05, which covers its own roundings and those of `lost`; no greater_5 of
   which the error may be below .49 exceeds 2^22, and what underflow takes of such an error is a part of the 4 u as well. *)
Definition inflation : Q := match error with Mul _ (Times i _) => i | _ => 0%Q end.
Definition kernels_term : Q := match error with Mul _ (Times _ (Add (Const c) _)) => c | _ => 0%Q end.
Lemma error_is : error = Mul (Given greater_5 0) (Times inflation (Add (Const kernels_term) (Given quotient_2 5))) /\
  quotient_2_under = Abs sum /\ quotient_2_over_constant = 2%Q /\ greater_5_other = Mul (Given width 0) (Given greater_4 0).
Proof. repeat split; reflexivity. Qed.
Lemma error_of_one_is : of_one = texel /\ of_one_rest = (-1 # 2)%Q /\
  error_of_one = Mul (Given width 0) (Mul (Given greater_4 0) (Times inflation (Add (Const kernels_term) (Given quotient_2 5)))).
Proof. repeat split; reflexivity. Qed.
Lemma inflation_is_enough : (1 <= inflation * (999 # 1000) * (1 - alphaQ u32Q 16) /\ least_term <= kernels_term /\
  least_rest + (1 # 2 ^ 90) <= error_rest * (1 - alphaQ u32Q 1) /\ takes (2 ^ 22) error <= 1 # 2 ^ 90 /\
  least_of_one <= kernels_term /\ least_rest_of_one + (1 # 2 ^ 30) <= error_of_one_rest * (1 - alphaQ u32Q 1) /\
  takes (2 ^ 31) error_of_one <= 1 # 2 ^ 30)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_term kernels_term.
Print constants.
Definition rests := Eval vm_compute in shown least_of_one kernels_term.
Print rests.
Definition checked := (lost_near, quotient_near, texel_near, alpha_near, one_is_between, error_of_one_is, inflation_is_enough).
Print Assumptions checked.
