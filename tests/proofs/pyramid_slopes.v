(* SPDX-License-Identifier: MIT *)
(* horizons.cl: a light's slope against the slope from a point to a height of the pyramid (docs/numerics.md, 16).
     height_near       a point's height is off by 2.01 u of itself;
     lit_is_above      a light that is computed to be above the greatest slope of a step is above the ground there;
     dark_is_below     one that is computed to be below the slope to the least height at a step's begin is below the ground.

   Assumed: lights are above the horizontal (make_sector_bundles takes no others); a light's slope and 1 / q have met one
   rounding; the pyramid's whole numbers are at least 1/100 unit beyond the ground's heights, which are 0 to 65535 units
   (FIELD_SLACK, 1/16, has what the roundings of triangles' heights, 10 u of 65535 each, need beside: prose); no result is
   below 2^-126 unless it is 0. Overflow: heights are below 2^20 units. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition z := 0%nat.
Definition lowest := 1%nat.
Definition units := 2%nat.
Definition bound := 3%nat.
Definition inverse := 4%nat.
Definition light := 5%nat.
Definition height :=
  Mul (Given units 0) (Diff z lowest).
Definition slope :=
  Mul (Given inverse 0) (Sub (Given bound 0) height).
(* less = less_constant * (Given light 0) *)
Definition less_constant : Q := 4194301 # 4194304.
(* more = more_constant * (Given light 0) *)
Definition more_constant : Q := 4194307 # 4194304.
Definition slack :=
  Const (1 # 16).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Definition shared := 99%nat.  (* the computed height *)
Definition slope_of a := Mul (Given inverse 0) (Sub (Given bound 0) a).
Lemma slope_is : slope = slope_of height.
Proof. reflexivity. Qed.

Section Step.
Variable x : nat -> R.
Definition real_height := x units * (x z - x lowest).
Theorem height_near h : computed x height h -> Rabs (h - real_height) <= 201 / 100 * u * Rabs real_height.
Proof.
  intros C. apply near in C. assert (A := alpha_below 2 ltac:(lia)). simpl INR in A. cbn -[u32 alpha] in C.
  rewrite <- Rabs_mult in C. fold real_height in C. assert (H := Rabs_pos real_height).
  assert (E := Rmult_le_compat_r _ _ _ (Rabs_pos real_height) A). lra.
Qed.

Variables S q G : R.  (* the light's slope, the step's begin, the ground's height *)
Let P := real_height.
Let h := x shared.
Let i := x inverse.
Hypotheses (S0 : 0 < S) (q0 : 0 < q) (G_in : 0 <= G <= 65535).
Hypotheses (light_near : Rabs (x light - S) <= 101 / 100 * u * S) (inverse_near : Rabs (i - / q) <= 101 / 100 * u * / q).
Hypotheses (h_is : computed x height h).
Definition least_around : Q := 75 # 167772160.

(* The computed difference and slope. *)
Lemma slope_near s : computed x (slope_of (Given shared 0)) s -> exists d,
  Rabs (d - (x bound - h)) <= u * Rabs (x bound - h) /\ Rabs (s * q - d) <= 202 / 100 * u * Rabs d.
Proof.
  intros C. destruct (step_mul _ _ _ _ C) as (j & d & Cj & Cd & N1). apply given_is in Cj. subst j. fold i in N1.
  destruct (step_sub _ _ _ _ Cd) as (b & k & Cb & Ck & N2). apply given_is in Cb, Ck. subst b k. fold h in N2.
  exists d. split; [exact N2 |]. assert (I := Rinv_0_lt_compat _ q0).
  assert (E : Rabs (i * q - 1) <= 101 / 100 * u).
  { replace (i * q - 1) with ((i - / q) * q) by (field; lra). rewrite Rabs_mult, (Rabs_pos_eq q) by lra.
    assert (H := Rmult_le_compat_r q _ _ ltac:(lra) inverse_near).
    replace (101 / 100 * u * / q * q) with (101 / 100 * u) in H by (field; lra). lra. }
  replace (s * q - d) with ((s - i * d) * q + (i * q - 1) * d) by ring. eapply Rle_trans; [apply Rabs_triang |].
  rewrite !Rabs_mult, (Rabs_pos_eq q) by lra. assert (M1 := Rmult_le_compat_r q _ _ ltac:(lra) N1).
  rewrite Rabs_mult in M1. assert (M2 := Rmult_le_compat_r _ _ _ (Rabs_pos d) E).
  assert (iq : Rabs i * q <= 1 + 101 / 100 * u).
  { rewrite <- (Rabs_pos_eq q) at 1 by lra. rewrite <- Rabs_mult. apply between in E. apply Rabs_le. lra. }
  assert (M3 := Rmult_le_compat_r _ _ _ (Rabs_pos d) iq). assert (Z := Rabs_pos d). lra.
Qed.

(* A height is off by less than 1/100 unit, or by 2.01 u of how far it is below the ground. *)
Lemma height_off : 0 < G - P -> Rabs (h - P) <= / 100 + 202 / 100 * u * (G - P).
Proof.
  intros D. assert (N := height_near _ h_is). fold P in N. destruct (Rle_dec 0 P) as [p | p].
  - rewrite (Rabs_pos_eq P) in N by lra. lra.
  - rewrite (Rabs_left1 P) in N by lra. lra.
Qed.

Theorem lit_is_above c l s t : computed x (Times c (Given light 0)) l -> computed x (slope_of (Given shared 0)) s ->
  0 <= Q2R c <= 1 - Q2R least_around -> G + / 100 <= x bound -> q <= t -> s < l -> G - P < S * t.
Proof.
  intros Cl Cs Hc bound_in qt H. destruct (Rle_dec (G - P) 0) as [D | D].
  { assert (Z : 0 < S * t) by (apply Rmult_lt_0_compat; lra). lra. }
  assert (O := height_off ltac:(lra)). destruct (slope_near _ Cs) as (d & N1 & N2).
  replace (Q2R least_around) with (75 / 10 * u) in Hc by (unfold Q2R, least_around; simpl; lra).
  destruct (step_times _ _ _ _ Cl) as (y & Cy & N3). apply given_is in Cy. subst y.
  assert (St := Rmult_le_compat_l S _ _ ltac:(lra) qt). assert (Sq : 0 < S * q) by (apply Rmult_lt_0_compat; lra).
  apply between in O, light_near. assert (light0 : 0 <= x light) by lra.
  assert (cl0 : 0 <= Q2R c * x light) by (apply Rmult_le_pos; lra). rewrite (Rabs_pos_eq (Q2R c * x light)) in N3 by lra.
  assert (cl1 := Rmult_le_compat_r (x light) _ _ light0 (proj2 Hc)). apply between in N3.
  assert (lq : l * q <= (1 - 54 / 10 * u) * (S * q)).
  { assert (L : l <= (1 - 54 / 10 * u) * S) by lra. assert (M := Rmult_le_compat_r q _ _ ltac:(lra) L). lra. }
  assert (sl : s * q < l * q) by (apply Rmult_lt_compat_r; lra).
  assert (b : (1 - 203 / 100 * u) * (G - P) <= x bound - h) by lra.
  rewrite (Rabs_pos_eq (x bound - h)) in N1 by lra. apply between in N1. assert (d0 : 0 <= d) by lra.
  rewrite (Rabs_pos_eq d) in N2 by lra. apply between in N2. lra.
Qed.

Theorem dark_is_below c m s : computed x (Times c (Given light 0)) m -> computed x (slope_of (Given shared 0)) s ->
  1 + Q2R least_around <= Q2R c <= 2 -> x bound <= G - / 100 -> m < s -> S * q < G - P.
Proof.
  intros Cm Cs Hc bound_in H. destruct (slope_near _ Cs) as (d & N1 & N2).
  replace (Q2R least_around) with (75 / 10 * u) in Hc by (unfold Q2R, least_around; simpl; lra).
  destruct (step_times _ _ _ _ Cm) as (y & Cy & N3). apply given_is in Cy. subst y.
  assert (Sq : 0 < S * q) by (apply Rmult_lt_0_compat; lra). apply between in light_near.
  assert (light0 : 0 < x light) by lra.
  assert (cl1 := Rmult_le_compat_r (x light) _ _ ltac:(lra) (proj1 Hc)).
  rewrite (Rabs_pos_eq (Q2R c * x light)) in N3 by lra.
  apply between in N3.
  assert (mq : (1 + 54 / 10 * u) * (S * q) <= m * q).
  { assert (L : (1 + 54 / 10 * u) * S <= m) by lra. assert (M := Rmult_le_compat_r q _ _ ltac:(lra) L). lra. }
  assert (sm : m * q < s * q) by (apply Rmult_lt_compat_r; lra).
  assert (d0 : 0 < d).
  { destruct (Rle_dec d 0) as [n |]; [| lra]. rewrite (Rabs_left1 d) in N2 by lra. apply between in N2. lra. }
  rewrite (Rabs_pos_eq d) in N2 by lra. apply between in N2.
  assert (b0 : 0 < x bound - h).
  { destruct (Rle_dec (x bound - h) 0) as [n |]; [| lra]. rewrite (Rabs_left1 (x bound - h)) in N1 by lra.
  apply between in N1. lra. }
  rewrite (Rabs_pos_eq (x bound - h)) in N1 by lra. apply between in N1.
  assert (D : 0 < G - P).
  { assert (N := height_near _ h_is). fold P in N. destruct (Rle_dec 0 P) as [p | p]; [| lra].
    rewrite (Rabs_pos_eq P) in N by lra. apply between in N. lra. }
  assert (O := height_off D). apply between in O. lra.
Qed.
End Step.

Definition kernels_slack : Q := match slack with Const c => c | _ => 0%Q end.
Lemma kernels_are_enough : (less_constant <= 1 - least_around /\ 1 + least_around <= more_constant /\
  (1 # 100) + 10 * u32Q * 65535 <= kernels_slack)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_around (1 - less_constant).
Print constants.
Definition rests := Eval vm_compute in shown least_around (more_constant - 1).
Print rests.
Definition checked := (height_near, lit_is_above, dark_is_below, kernels_are_enough).
Print Assumptions checked.
