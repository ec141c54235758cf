(* SPDX-License-Identifier: MIT *)
(* loose: BEAM_ROUNDING also serves the extents of leaves along a light's axes, which need 3.2e-6 of it (leaf_extents.v) *)
(* beam_intersect.clh, parallel_packets.clh, converging_packets.clh: rays against the tree's boxes. A ray is never computed
   to enter a box later, or to leave it earlier, than it does; so no node that it meets is left out.
     enter_is_early, leave_is_late      parallel rays, t = (side - P) / D;
     moved_low_is_low, moved_high_is_high   a side relative to the rays' origin, and moved by `rounding`, is still outside;
     reached_is_near, interval_is_kept  rays from an origin, whose D has met one rounding: t = side / D.

   Assumed: no coordinate exceeds L; `rounding` is at least 0.9999 of BEAM_ROUNDING L, and at most L; a quotient is off by
   2.5 ulp; no result is below 2^-126 unless it is 0. Here D > 0; where D < 0 all signs turn. In prose: the coordinates of D
   that are replaced by 2^-40 or 2^-100, since they are smaller, move a ray by less than `rounding` has left; a packet's box
   of points (most, least) is met by the ray of one of its points. point_beam.clh moves a side as moved_side() does. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition low := 0%nat.
Definition high := 1%nat.
Definition P := 2%nat.
Definition rounding := 3%nat.
Definition inverse := 4%nat.
Definition rounded_inverse := 5%nat.
Definition origin := 6%nat.
Definition side := 7%nat.
Definition enter :=
  Sub (Mul (Given inverse 5) (Diff low rounding)) (Mul (Given P 0) (Given inverse 5)).
Definition leave :=
  Sub (Mul (Add (Given high 0) (Given rounding 0)) (Given inverse 5)) (Mul (Given P 0) (Given inverse 5)).
Definition moved_low :=
  Sub (Diff low origin) (Given rounding 0).
Definition moved_high :=
  Add (Given rounding 0) (Diff high origin).
Definition reached :=
  Mul (Given rounded_inverse 6) (Given side 0).
Definition less :=
  Const (16777199 # 16777216).
Definition factor :=
  Const (8796093 # 2199023255552).
(* end: from the kernels *)

Open Scope R_scope.
Section Boxes.
Variable x : nat -> R.
Variables D L : R.
Local Notation computed := (computed x).

(* ---- Parallel rays ---- *)
Definition least_factor : Q := 161 # 167772160.
Hypotheses (D0 : 0 < D) (inverse_is : x inverse = / D).
Hypotheses (low_in : Rabs (x low) <= L) (high_in : Rabs (x high) <= L) (P_in : Rabs (x P) <= L).
Hypotheses (enough : Q2R least_factor * L <= x rounding).

Lemma times_inverse a : Rabs (x inverse) * a = a * / D.
Proof. rewrite inverse_is, Rabs_pos_eq; [ring | left; now apply Rinv_0_lt_compat]. Qed.
Lemma L0 : 0 <= L.
Proof. eapply Rle_trans; [apply Rabs_pos | exact P_in]. Qed.
Lemma enough' : 161 / 167772160 * L <= x rounding.
Proof. replace (161 / 167772160) with (Q2R least_factor) by (unfold Q2R, least_factor; simpl; lra). exact enough. Qed.

(* The error of what is computed, times D. *)
Lemma eight_below : alpha u32 8 * ((2 * L + Rabs (x rounding)) * / D) <= x rounding * / D.
Proof.
  assert (I := Rinv_0_lt_compat _ D0). assert (l0 := L0). assert (E := enough').
  rewrite (Rabs_pos_eq (x rounding)) by lra. rewrite <- Rmult_assoc. apply Rmult_le_compat_r; [lra |].
  assert (A := alpha_below 8 ltac:(lia)). simpl INR in A.
  assert (G := Rmult_le_compat_r (2 * L + x rounding) _ _ ltac:(lra) A). lra.
Qed.

Theorem enter_is_early v t : computed enter v -> x low <= x P + t * D -> v <= t.
Proof.
  intros C H. apply near in C. assert (I := Rinv_0_lt_compat _ D0). assert (l0 := L0). assert (E := enough').
  cbn -[u32 alpha] in C. rewrite times_inverse, (Rmult_comm (Rabs (x P))), times_inverse in C.
  assert (G := eight_below).
  assert (S : Rabs (x low - x rounding) * / D + Rabs (x P) * / D <= (2 * L + Rabs (x rounding)) * / D).
  { rewrite <- Rmult_plus_distr_r. apply Rmult_le_compat_r; [lra |]. assert (T := Rabs_triang (x low) (- x rounding)).
    rewrite Rabs_Ropp in T. unfold Rminus. lra. }
  assert (G' := Rmult_le_compat_l _ _ _ (alpha_at_least 8) S). apply between in C. rewrite inverse_is in C.
  assert (t_is : (x low - x P) * / D <= t).
  { replace t with (t * D * / D) by (field; lra). apply Rmult_le_compat_r; lra. }
  lra.
Qed.

Theorem leave_is_late v t : computed leave v -> x P + t * D <= x high -> t <= v.
Proof.
  intros C H. apply near in C. assert (I := Rinv_0_lt_compat _ D0). assert (l0 := L0). assert (E := enough').
  cbn -[u32 alpha] in C. rewrite !(Rmult_comm _ (Rabs (x inverse))), !times_inverse in C.
  assert (G := eight_below).
  assert (S : (Rabs (x high) + Rabs (x rounding)) * / D + Rabs (x P) * / D <= (2 * L + Rabs (x rounding)) * / D).
  { rewrite <- Rmult_plus_distr_r. apply Rmult_le_compat_r; lra. }
  assert (G' := Rmult_le_compat_l _ _ _ (alpha_at_least 8) S). apply between in C. rewrite inverse_is in C.
  assert (t_is : t <= (x high - x P) * / D).
  { replace t with (t * D * / D) by (field; lra). apply Rmult_le_compat_r; lra. }
  lra.
Qed.

(* ---- Rays from an origin ---- *)
Hypotheses (origin_in : Rabs (x origin) <= L) (not_much : x rounding <= L).

Theorem moved_low_is_low v : computed moved_low v -> v <= x low - x origin.
Proof.
  intros C. apply near in C. assert (l0 := L0). assert (E := enough'). cbn -[u32 alpha] in C.
  rewrite (Rabs_pos_eq (x rounding)) in C by lra. assert (T := Rabs_triang (x low) (- x origin)). rewrite Rabs_Ropp in T.
  assert (A := alpha_below 2 ltac:(lia)). simpl INR in A.
  assert (S : Rabs (x low - x origin) + x rounding <= 2 * L + x rounding) by (unfold Rminus; lra).
  assert (S0 : 0 <= Rabs (x low - x origin) + x rounding) by (assert (Z := Rabs_pos (x low - x origin)); lra).
  assert (G := Rmult_le_compat _ _ _ _ (alpha_at_least 2) S0 A S). apply between in C. lra.
Qed.
Theorem moved_high_is_high v : computed moved_high v -> x high - x origin <= v.
Proof.
  intros C. apply near in C. assert (l0 := L0). assert (E := enough'). cbn -[u32 alpha] in C.
  rewrite (Rabs_pos_eq (x rounding)) in C by lra. assert (T := Rabs_triang (x high) (- x origin)). rewrite Rabs_Ropp in T.
  assert (A := alpha_below 2 ltac:(lia)). simpl INR in A.
  assert (S : x rounding + Rabs (x high - x origin) <= 2 * L + x rounding) by (unfold Rminus; lra).
  assert (S0 : 0 <= x rounding + Rabs (x high - x origin)) by (assert (Z := Rabs_pos (x high - x origin)); lra).
  assert (G := Rmult_le_compat _ _ _ _ (alpha_at_least 2) S0 A S). apply between in C. lra.
Qed.

Theorem reached_is_near v : x rounded_inverse = / D -> computed reached v ->
  Rabs (v - x side / D) <= 701 / 100 * / 16777216 * Rabs (x side / D).
Proof.
  intros I C. apply near in C. cbn -[u32 alpha] in C. rewrite I in C. rewrite <- Rabs_mult in C.
  assert (A := alpha_below 7 ltac:(lia)). simpl INR in A.
  assert (Z := Rabs_pos (/ D * x side)). assert (G := Rmult_le_compat_r _ _ _ Z A).
  replace (x side / D) with (/ D * x side) by (unfold Rdiv; ring). lra.
Qed.
End Boxes.

(* t lies between begin and end, which are computed as b and e; s is the computed b LESS_THAN_ONE. *)
Definition least_less : Q := 151 # 167772160.
Theorem interval_is_kept t first last b e s one :
  0 <= first <= t -> t <= last ->
  Rabs (b - first) <= 701 / 100 * / 16777216 * first -> Rabs (e - last) <= 701 / 100 * / 16777216 * last ->
  Q2R one <= 1 - Q2R least_less -> 0 <= Q2R one -> Rabs (s - b * Q2R one) <= / 16777216 * (b * Q2R one) -> s <= e.
Proof.
  intros [f0 ft] tl Hb He Hone one0 Hs. replace (Q2R least_less) with (151 / 167772160) in Hone
    by (unfold Q2R, least_less; simpl; lra).
  apply between in Hb. apply between in He. apply between in Hs.
  assert (b0 : 0 <= b) by lra.
  assert (G := Rmult_le_compat_l _ _ _ b0 Hone). lra.
Qed.
Definition of_expr e := match e with Const q => q | _ => 0%Q end.
Definition constants := Eval vm_compute in shown least_less (1 - of_expr less)%Q.
Print constants.
Definition rests := Eval vm_compute in shown least_factor (of_expr factor).
Print rests.
Definition checked := (enter_is_early, leave_is_late, moved_low_is_low, moved_high_is_high, reached_is_near, interval_is_kept).
Print Assumptions checked.
