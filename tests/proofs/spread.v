(* SPDX-License-Identifier: MIT *)
(* footprints.clh: a footprint contains its shading points (docs/numerics.md, 9).
     corner_is_near                 a hit is off by at most its error, but for .1 % and 2^-104;
     footprint_has_its_points       of a footprint made from the hits of four rays;
     parallelogram_has_its_points   of one made from two sides of the receiver: both need 34.1 u of the 50 u.

   Assumed: 1 / 1.05 of `relative`, up to .71, is what t is off by (nearness.v: 1.334 of 1.4); a ray's coordinates are
   rounded once, beside sizes up to 2.5 times its largest (its column and row are at right angles); a hit on the plane
   is a mean of the four corners' (projective maps keep hulls: prose), or lies in the receiver; a shading point is
   within 9 ulp of it (camera.h), 18 u of the larger of hit and eye; `largest` is at least each coordinate of the hits,
   of the receiver's corners and of the eye; `rest` is at least |twist|; a ray's largest coordinate is from 2^-10
   (require_camera(): its axes are at most 2 long and span .01) to 2^20 (no greater one has bounds, and its hit is not met).
   Denormals may be kept or flushed: the spread's 1e-30 has room for what that takes. The other 16 u are for sums of positions in facing_blocks.clh, in prose: at most 11 u there. Overflow: no footprint is
   used whose spread or positions reach 1e30. *)
From Coq Require Import Reals QArith Qreals Lra Lia Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition t := 0%nat.
Definition ray := 1%nat.
Definition eye := 2%nat.
Definition relative := 3%nat.
Definition reach := 4%nat.
Definition ray_size := 5%nat.
Definition eye_size := 6%nat.
Definition hit_0 := 7%nat.
Definition hit_1 := 8%nat.
Definition hit_2 := 9%nat.
Definition hit_3 := 10%nat.
Definition rest := 11%nat.
Definition error := 12%nat.
Definition largest := 13%nat.
Definition a := 14%nat.
Definition b := 15%nat.
Definition c := 16%nat.
Definition corner :=
  Fma (Given ray 0) (Given t 0) (Given eye 0).
Definition corner_error :=
  Add (Times (1 # 16777216) (Add (Times (3 # 1) (Add (Given eye_size 0) (Given reach 0))) (Mul (Given ray_size 0)
    (Given t 0)))) (Mul (Given reach 0) (Given relative 0)).
Definition centre :=
  Times (1 # 4) (Add (Add (Add (Given hit_0 0) (Given hit_1 0)) (Given hit_2 0)) (Given hit_3 0)).
Definition along_u :=
  Times (1 # 4) (Add (Given hit_3 0) (Sub (Diff hit_1 hit_0) (Given hit_2 0))).
Definition along_v :=
  Times (1 # 4) (Add (Add (Given hit_2 0) (Sub (Neg (Given hit_1 0)) (Given hit_0 0))) (Given hit_3 0)).
Definition twist :=
  Times (1 # 4) (Add (Given hit_3 0) (Sub (Diff hit_0 hit_1) (Given hit_2 0))).
Definition spread :=
  Add (Const (332307 # 332306998946228968225951765070086144)) (Times (4236247 # 4194304) (Add (Add (Given error 0)
    (Given rest 0)) (Times (25 # 8388608) (Given largest 0)))).
Definition own_centre :=
  Add (Add (Times (1 # 2) (Diff b a)) (Times (1 # 2) (Diff c a))) (Given a 0).
Definition own_u :=
  Times (1 # 2) (Diff b a).
Definition own_v :=
  Times (1 # 2) (Diff c a).
(* own_spread = own_spread_constant * (Given largest 0) *)
Definition own_spread_constant : Q := 25 # 8388608.
Definition own_spread_rest : Q := 332307 # 332306998946228968225951765070086144.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).

(* The kernel's text: the constants of both spreads. *)
Definition spread_of (r i c : Q) := Add (Const r) (Times i (Add (Add (Given error 0) (Given rest 0)) (Times c (Given
  largest
  0)))).
Definition inflation : Q := match spread with Add _ (Times i _) => i | _ => 0%Q end.
Definition of_largest : Q := match spread with Add _ (Times _ (Add _ (Times c _))) => c | _ => 0%Q end.
Definition of_nothing : Q := match spread with Add (Const r) _ => r | _ => 0%Q end.
Lemma kernel_is : spread = spread_of of_nothing inflation of_largest.
Proof. reflexivity. Qed.
Definition least_inflation : Q := 10099 # 10000.
Definition least_of_largest : Q := 341 # 167772160.

Local Notation tiny' := (/ 20282409603651670423947251286016).  (* 2^-104, of hits *)
Local Notation few := (/ 1298074214633706907132624082305024).  (* 2^-110, of sums *)
Definition least_of_nothing : Q := 1 # 2535301200456458802993406410752.  (* 2^-101 *)

Lemma near_of_size x e v k p L : computes32 x e v -> roundings e = k -> (k <= 16)%nat -> lost32 x e <= 40 * h32 ->
  permanent x e <= p * L -> 0 <= p -> 0 <= L -> Rabs (v - real x e) <= INR k * (1 + / 1048576) * u * (p * L) + few.
Proof.
  intros C K k16 W P p0 L0. apply near32 in C. rewrite K in C. assert (A := alpha_below k k16).
  assert (h1 := h32_below). simpl in h1.
  assert (G := Rmult_le_compat _ _ _ _ (alpha_at_least k) (permanent_positive x e) A P). lra.
Qed.
Ltac loses_little := unfold lost32; cbn -[u32 h32 Q2R]; rewrite ?u32_value; assert (h := h32_positive);
  repeat match goal with |- context [Rabs (Q2R ?q)] => replace (Rabs (Q2R q)) with (Q2R q) by (symmetry; apply Rabs_pos_eq;
    unfold Q2R; simpl; lra) end; unfold Q2R; simpl; lra.
Lemma times_in t y z : -1 <= t <= 1 -> Rabs y <= z -> - z <= t * y <= z.
Proof.
  intros T Y. apply between. rewrite Rabs_mult. assert (t1 : Rabs t <= 1) by (apply Rabs_le; lra).
  assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) t1 Y). lra.
Qed.

Section Corner.
Variable x : nat -> R.
Let r := x relative.
Let s := x ray_size.
Variables m T D : R.  (* the ray's largest coordinate, as computed; the real distance and the real ray *)
Hypotheses (t0 : 0 <= x t) (m0 : 0 <= m) (s0 : 0 <= s) (r_in : 0 <= r <= 71 / 100).
Hypothesis eye_in : Rabs (x eye) <= x eye_size.
Hypotheses (t_near : Rabs (x t - T) <= 20 / 21 * r * x t) (ray_near : Rabs (x ray - D) <= u * s).
Hypothesis ray_in : Rabs (x ray) <= m.
Hypotheses (reach_is : Rabs (x reach - x t * m) <= u * (x t * m) + tiny' / 2) (s_in : m <= s <= 5 / 2 * m).
Hypotheses (m_in : / 1024 <= m <= 1048576) (reach0 : 0 <= x reach).
Theorem corner_is_near v e : computes32 x corner v -> computes32 x corner_error e ->
  Rabs (v - (x eye + T * D)) <= 1001 / 1000 * e + tiny'.
Proof.
  intros Cv Ce. assert (e0 := Rle_trans _ _ _ (Rabs_pos _) eye_in). set (M := x t * m) in *.
  assert (M0 : 0 <= M) by (unfold M; now apply Rmult_le_pos). assert (reach_b := between _ _ reach_is).
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  apply near32 in Cv, Ce. assert (A1 := alpha_below 1 ltac:(lia)). assert (A5 := alpha_below 5 ltac:(lia)).
  simpl INR in A1, A5. unfold lost32 in Cv, Ce. cbn -[u32 h32 alpha Q2R] in Cv, Ce. unfold of_product in Cv, Ce.
  assert (z : alpha u32 0 = 0) by (unfold alpha; simpl; lra). assert (Z1 := alpha_at_least 1). assert (Z5 := alpha_at_least 5).
  rewrite ?z, !u32_value in Cv, Ce. rewrite u32_value in A1, A5, Z1, Z5.
  fold r s in Ce. rewrite (Rabs_pos_eq (x t)) in Cv by lra.
  replace (Q2R (1 # 16777216)) with u in Ce by (unfold Q2R; simpl; lra).
  replace (Q2R (3 # 1)) with 3 in Ce by (unfold Q2R; simpl; lra).
  rewrite (Rabs_pos_eq u), (Rabs_pos_eq 3), (Rabs_pos_eq (x reach)), (Rabs_pos_eq r), (Rabs_pos_eq s),
    (Rabs_pos_eq (x t)), (Rabs_pos_eq (x eye_size)) in Ce by lra.
  assert (td : x t * Rabs (x ray) <= M) by (unfold M; apply Rmult_le_compat_l; lra).
  assert (td0 : 0 <= x t * Rabs (x ray)) by (apply Rmult_le_pos; auto using Rabs_pos).
  assert (V := Rmult_le_compat _ _ _ _ Z1 (Rplus_le_le_0_compat _ _ td0 (Rabs_pos (x eye))) A1
    (Rplus_le_compat _ _ _ _ td eye_in)).
  assert (ts : 0 <= s * x t) by (now apply Rmult_le_pos). assert (ts1 : s * x t <= 5 / 2 * M).
  { assert (G := Rmult_le_compat_r _ _ _ t0 (proj2 s_in)). unfold M. lra. }
  assert (rM : 0 <= r * M) by (apply Rmult_le_pos; lra).
  assert (rr : (1 - u) * (r * M) - tiny' / 2 <= x reach * r).
  { assert (G := Rmult_le_compat_r r _ _ (proj1 r_in) (proj1 reach_b)).
    assert (r1 := Rmult_le_compat_r tiny' _ _ ltac:(lra) (proj2 r_in)). lra. }
  (* What underflow takes: of t no more than of the reach, as a ray is long enough. *)
  assert (tM : x t <= 1024 * M).
  { assert (G := Rmult_le_compat_l _ _ _ t0 (proj1 m_in)). unfold M. lra. }
  assert (ht := Rmult_le_compat_l h32 _ _ ltac:(lra) tM). assert (ht0 : 0 <= h32 * x t) by (apply Rmult_le_pos; lra).
  assert (hM := Rmult_le_compat_r M _ _ M0 h1).
  assert (hray : 0 <= h32 * Rabs (x ray) <= h32 * 1048576) by (split; [apply Rmult_le_pos; [lra | apply Rabs_pos] |
    apply Rmult_le_compat_l; lra]).
  assert (hs : 0 <= h32 * s <= h32 * 2621440) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
  assert (hreach : 0 <= h32 * x reach <= h32 * (2 * M + 1)) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
  assert (hr : 0 <= h32 * r <= h32) by (split; [apply Rmult_le_pos | rewrite <- (Rmult_1_r h32) at 2; apply
    Rmult_le_compat_l]; lra).
  assert (hh : 0 <= h32 * h32 <= h32 * / 100) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra).
  set (Z := u * (3 * (x eye_size + x reach) + s * x t) + x reach * r) in *.
  assert (rr0 : 0 <= x reach * r) by (apply Rmult_le_pos; lra).
  assert (Z0 : 0 <= Z) by (unfold Z; lra). assert (E := Rmult_le_compat_r Z _ _ Z0 A5). apply between in Ce.
  assert (D_in : Rabs D <= m + u * s).
  { assert (G := Rabs_triang (x ray) (- (x ray - D))). rewrite Rabs_Ropp in G.
    replace (x ray + - (x ray - D)) with D in G by ring. lra. }
  assert (F1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) t_near D_in). rewrite <- Rabs_mult in F1.
  assert (F2 := Rmult_le_compat_l _ _ _ t0 ray_near). rewrite <- (Rabs_pos_eq (x t) t0) in F2 at 1.
  rewrite <- Rabs_mult in F2.
  assert (rts : r * (s * x t) <= 71 / 100 * (5 / 2 * M)) by (apply Rmult_le_compat; lra).
  replace (20 / 21 * r * x t * (m + u * s)) with (20 / 21 * (r * M) + 20 / 21 * u * (r * (s * x t))) in F1
    by (unfold M; ring).
  replace (v - (x eye + T * D)) with ((v - (x t * x ray + x eye)) + ((x t - T) * D + x t * (x ray - D))) by ring.
  apply between in Cv, F1, F2. apply Rabs_le. unfold Z in *. lra.
Qed.
End Corner.

Section Hits.
Variable x : nat -> R.
Let L := x largest.
Variables H0 H1 H2 H3 off P : R.  (* the real hits, what the computed ones are off by, and a shading point *)
Hypotheses (near_0 : Rabs (x hit_0 - H0) <= off) (near_1 : Rabs (x hit_1 - H1) <= off).
Hypotheses (near_2 : Rabs (x hit_2 - H2) <= off) (near_3 : Rabs (x hit_3 - H3) <= off).
Hypotheses (in_0 : Rabs (x hit_0) <= L) (in_1 : Rabs (x hit_1) <= L) (in_2 : Rabs (x hit_2) <= L) (in_3 : Rabs (x
  hit_3) <= L).
Hypothesis off_below : off <= 1008 / 1000 * x error + 2 * tiny'.
Hypothesis error0 : 0 <= x error.
Variables m0 m1 m2 m3 : R.  (* the hit is a mean of the corners' *)
Hypotheses (m_positive : 0 <= m0 /\ 0 <= m1 /\ 0 <= m2 /\ 0 <= m3) (m_sum : m0 + m1 + m2 + m3 = 1).
Hypothesis P_near : Rabs (P - (m0 * H0 + m1 * H1 + m2 * H2 + m3 * H3)) <= 18 * u * (L + off).
Variables r i c : Q.
Hypotheses (r0 : Q2R least_of_nothing <= Q2R r <= 1) (i_in : Q2R least_inflation <= Q2R i <= 2) (c_in : Q2R least_of_largest <= Q2R c <= 1).

Theorem footprint_has_its_points vC vU vV vR s :
  computes32 x centre vC -> computes32 x along_u vU -> computes32 x along_v vV -> computes32 x twist vR ->
  Rabs vR <= x rest -> computes32 x (spread_of r i c) s ->
  exists a b, -1 <= a <= 1 /\ -1 <= b <= 1 /\ Rabs (P - (vC + a * vU + b * vV)) <= s.
Proof.
  intros CC CU CV CR rest_in Cs.
  assert (L0 := Rle_trans _ _ _ (Rabs_pos _) in_0). assert (off0 := Rle_trans _ _ _ (Rabs_pos _) near_0).
  assert (quarter : Rabs (Q2R (1 # 4)) = / 4) by (rewrite Rabs_pos_eq by (unfold Q2R; simpl; lra); unfold Q2R; simpl;
    lra).
  assert (four : Q2R (1 # 4) = / 4) by (unfold Q2R; simpl; lra).
  assert (diff : forall j k, Rabs (x j) <= L -> Rabs (x k) <= L -> Rabs (x j - x k) <= 2 * L).
  { intros j k J K. apply between in J, K. apply Rabs_le. lra. }
  assert (d10 := diff _ _ in_1 in_0). assert (d01 := diff _ _ in_0 in_1).
  assert (NC := near_of_size _ _ _ 4 1 L CC eq_refl ltac:(lia) ltac:(loses_little) ltac:(cbn -[Q2R]; rewrite quarter; lra) ltac:(lra) L0).
  assert (NU := near_of_size _ _ _ 4 1 L CU eq_refl ltac:(lia) ltac:(loses_little) ltac:(cbn -[Q2R]; rewrite quarter; lra) ltac:(lra) L0).
  assert (NV := near_of_size _ _ _ 4 1 L CV eq_refl ltac:(lia) ltac:(loses_little) ltac:(cbn -[Q2R]; rewrite quarter; lra) ltac:(lra) L0).
  assert (NR := near_of_size _ _ _ 4 1 L CR eq_refl ltac:(lia) ltac:(loses_little) ltac:(cbn -[Q2R]; rewrite quarter; lra) ltac:(lra) L0).
  simpl INR in NC, NU, NV, NR. cbn -[Q2R] in NC, NU, NV, NR. rewrite four in NC, NU, NV, NR.
  (* The hits' own mean, by centre, axes and twist. *)
  set (a := - m0 + m1 - m2 + m3). set (b := - m0 - m1 + m2 + m3). set (d := m0 - m1 - m2 + m3).
  assert (a_in : -1 <= a <= 1) by (unfold a; lra). assert (b_in : -1 <= b <= 1) by (unfold b; lra).
  assert (d_in : -1 <= d <= 1) by (unfold d; lra).
  exists a, b. split; [exact a_in |]. split; [exact b_in |].
  assert (mean : Rabs (m0 * (H0 - x hit_0) + m1 * (H1 - x hit_1) + m2 * (H2 - x hit_2) + m3 * (H3 - x hit_3)) <= off).
  { assert (one : forall m y h, 0 <= m -> Rabs (h - y) <= off -> - (m * off) <= m * (y - h) <= m * off).
    { clear. intros m y h M N. apply between in N. assert (G := Rmult_le_compat_l m (y - h) off M ltac:(lra)).
      assert (G2 := Rmult_le_compat_l m (- off) (y - h) M ltac:(lra)). lra. }
    assert (A0 := one m0 H0 _ ltac:(lra) near_0). assert (A1 := one m1 H1 _ ltac:(lra) near_1).
    assert (A2 := one m2 H2 _ ltac:(lra) near_2). assert (A3 := one m3 H3 _ ltac:(lra) near_3).
    assert (S : m0 * off + m1 * off + m2 * off + m3 * off = off) by (rewrite <- !Rmult_plus_distr_r, m_sum; ring).
    apply Rabs_le. lra. }
  set (fC := / 4 * _) in NC. set (fU := / 4 * _) in NU. set (fV := / 4 * _) in NV. set (fR := / 4 * _) in NR.
  assert (same : m0 * x hit_0 + m1 * x hit_1 + m2 * x hit_2 + m3 * x hit_3 = fC + a * fU + b * fV + d * fR).
  { unfold fC, fU, fV, fR, a, b, d. replace m3 with (1 - m0 - m1 - m2) by lra. field. }
  assert (TU := times_in a _ _ a_in NU). assert (TV := times_in b _ _ b_in NV). assert (TR := times_in d _ _ d_in NR).
  assert (TR2 := times_in d _ _ d_in rest_in). assert (rest0 := Rle_trans _ _ _ (Rabs_pos _) rest_in).
  (* The spread. *)
  assert (i1 : 10099 / 10000 <= Q2R i) by (destruct i_in as [i_low _]; revert i_low; unfold Q2R at 1, least_inflation; simpl;
    lra).
  assert (c1 : 341 / 10 * u <= Q2R c) by (destruct c_in as [c_low _]; revert c_low; unfold Q2R at 1, least_of_largest; simpl;
    lra).
  assert (r1 : / 2535301200456458802993406410752 <= Q2R r) by (destruct r0 as [r_low _]; revert r_low; unfold Q2R at 1,
    least_of_nothing; simpl; lra).
  apply near32 in Cs. assert (A := alpha_below 4 ltac:(lia)). simpl INR in A. unfold lost32 in Cs.
  cbn -[u32 h32 alpha Q2R] in Cs. rewrite !u32_value in Cs. rewrite u32_value in A. fold L in Cs.
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  assert (ih : 0 <= Q2R i * h32 <= 2 * h32) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra).
  assert (ch : 0 <= Q2R c * h32 <= 1 * h32) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra).
  assert (ich : 0 <= Q2R i * (Q2R c * h32) <= 2 * (1 * h32)) by (split; [apply Rmult_le_pos | apply Rmult_le_compat]; lra).
  assert (cL := Rmult_le_compat_r L _ _ L0 c1).
  rewrite (Rabs_pos_eq (Q2R r)), (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq (Q2R c)), (Rabs_pos_eq L), (Rabs_pos_eq (x
    error)),
    (Rabs_pos_eq (x rest)) in Cs by lra.
  set (W := x error + x rest + Q2R c * L) in *. assert (W0 : 0 <= W) by (unfold W; lra).
  assert (iW := Rmult_le_compat_r W _ _ W0 i1). set (Z := Q2R r + Q2R i * W) in *. assert (Z0 : 0 <= Z) by (unfold Z;
    lra).
  assert (E := Rmult_le_compat_r Z _ _ Z0 A). apply between in Cs, P_near, NC, mean.
  assert (s1 : (1 - 401 / 100 * u) * (10099 / 10000 * W) + 99 / 100 * / 2535301200456458802993406410752 <= s) by (unfold Z in *; lra).
  apply Rabs_le. unfold W in s1. lra.
Qed.
End Hits.

Section Receiver.
Variable x : nat -> R.
Let L := x largest.
Hypotheses (in_a : Rabs (x a) <= L) (in_b : Rabs (x b) <= L) (in_c : Rabs (x c) <= L).
Variables m n P : R.  (* the hit lies in the receiver; a shading point *)
Hypotheses (m0 : 0 <= m) (n0 : 0 <= n) (in_triangle : m + n <= 1).
Hypothesis P_near : Rabs (P - (x a + m * (x b - x a) + n * (x c - x a))) <= 18 * u * L.

Theorem parallelogram_has_its_points vC vU vV k s :
  computes32 x own_centre vC -> computes32 x own_u vU -> computes32 x own_v vV -> Q2R least_of_largest <= Q2R k ->
  (1 - 2 * u) * (Q2R k * L) + 99 / 100 * Q2R least_of_nothing <= s ->
  exists p q, -1 <= p <= 1 /\ -1 <= q <= 1 /\ Rabs (P - (vC + p * vU + q * vV)) <= s.
Proof.
  intros CC CU CV Hk Hs. assert (L0 := Rle_trans _ _ _ (Rabs_pos _) in_a).
  assert (half : Rabs (Q2R (1 # 2)) = / 2) by (rewrite Rabs_pos_eq by (unfold Q2R; simpl; lra); unfold Q2R; simpl;
    lra).
  assert (two : Q2R (1 # 2) = / 2) by (unfold Q2R; simpl; lra).
  assert (ba : Rabs (x b - x a) <= 2 * L) by (apply between in in_a, in_b; apply Rabs_le; lra).
  assert (ca : Rabs (x c - x a) <= 2 * L) by (apply between in in_a, in_c; apply Rabs_le; lra).
  assert (NC := near_of_size _ _ _ 4 3 L CC eq_refl ltac:(lia) ltac:(loses_little) ltac:(cbn -[Q2R]; rewrite half; lra) ltac:(lra) L0).
  assert (NU := near_of_size _ _ _ 2 1 L CU eq_refl ltac:(lia) ltac:(loses_little) ltac:(cbn -[Q2R]; rewrite half; lra) ltac:(lra) L0).
  assert (NV := near_of_size _ _ _ 2 1 L CV eq_refl ltac:(lia) ltac:(loses_little) ltac:(cbn -[Q2R]; rewrite half; lra) ltac:(lra) L0).
  simpl INR in NC, NU, NV. cbn -[Q2R] in NC, NU, NV. rewrite two in NC, NU, NV.
  exists (2 * m - 1), (2 * n - 1). split; [lra |]. split; [lra |].
  assert (TU := times_in (2 * m - 1) _ _ ltac:(lra) NU). assert (TV := times_in (2 * n - 1) _ _ ltac:(lra) NV).
  assert (c1 : 341 / 10 * u <= Q2R k) by (revert Hk; unfold Q2R at 1, least_of_largest; simpl; lra).
  replace (Q2R least_of_nothing) with (/ 2535301200456458802993406410752) in Hs by (unfold Q2R, least_of_nothing; simpl;
    lra).
  assert (cL := Rmult_le_compat_r L _ _ L0 c1). apply between in P_near, NC. apply Rabs_le. lra.
Qed.
End Receiver.

Lemma kernels_are_enough :
  (least_inflation <= inflation <= 2 /\ least_of_largest <= of_largest <= 1 /\ least_of_nothing <= of_nothing <= 1 /\
   least_of_largest <= own_spread_constant /\ least_of_nothing <= own_spread_rest)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_of_largest of_largest.
Print constants.
Definition rests := Eval vm_compute in shown least_of_largest own_spread_constant.
Print rests.
Definition checked :=
  (corner_is_near, kernel_is, footprint_has_its_points, parallelogram_has_its_points, kernels_are_enough).
Print Assumptions checked.
