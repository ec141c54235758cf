(* SPDX-License-Identifier: MIT *)
(* horizons.cl: a light's slope against the slope from a point to a height of the pyramid (docs/numerics.md, 16).
     height_near       a point's height is off by 2.01 u of itself;
     lit_is_above      a light that is computed to be above the greatest slope of a step is above the ground there;
     dark_is_below     one that is computed to be below the slope to the least height at a step's begin is below the
        ground.

   Assumed: lights are above the horizontal (make_sector_bundles takes no others); a light's slope and 1 / q have
   met one rounding; the pyramid's whole numbers are at least 1/100 unit beyond the ground's heights, which are 0 to
   65535 units (FIELD_SLACK, 1/16, has what the roundings of triangles' heights, 10 u of 65535 each, need beside:
   prose); a step begins up to 2^20 half cells away; a unit of length has up to 2^76 units of height, as no cell is
   smaller than 2^-34 (set_grid()). Denormals may be kept or flushed. Overflow: heights are below 2^20 units. *)
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

Local Notation computed := computes32.
Local Notation tiny' := (/ 20282409603651670423947251286016).  (* 2^-104 *)
Local Notation of_height := (/ 16777216).  (* 2^-24 units, more than underflow takes of a height *)

Section Step.
Variable x : nat -> R.
Definition real_height := x units * (x z - x lowest).
Hypotheses (units_in : Rabs (x units) <= 75557863725914323419136) (z_in : Rabs (x z - x lowest) <= 4194304).
Theorem height_near h : computed x height h -> Rabs (h - real_height) <= 201 / 100 * u * Rabs real_height + of_height.
Proof.
  intros C. destruct (step32_mul _ _ _ _ C) as (U & d & CU & Cd & N). apply given32_is in CU. subst U.
  apply step32_diff in Cd. assert (e := h32_positive). assert (e1 := h32_below). simpl in e1. unfold real_height.
  set (U := x units) in *. set (D := x z - x lowest) in *.
  assert (dD : Rabs (U * d - U * D) <= u * Rabs (U * D) + 4 * h32 * Rabs U).
  { replace (U * d - U * D) with (U * (d - D)) by ring. rewrite !Rabs_mult.
    assert (G := Rmult_le_compat_l _ _ _ (Rabs_pos U) Cd). lra. }
  assert (T := Rabs_triang (U * d - U * D) (U * D)). replace (U * d - U * D + U * D) with (U * d) in T by ring.
  assert (d_in : Rabs d <= 4194305).
  { assert (T' := Rabs_triang (d - D) D). replace (d - D + D) with d in T' by ring. lra. }
  assert (hU := Rmult_le_compat_l h32 _ _ ltac:(lra) units_in).
  assert (hd := Rmult_le_compat_l h32 _ _ ltac:(lra) d_in). assert (Z := Rabs_pos (U * D)).
  replace (h - U * D) with ((h - U * d) + (U * d - U * D)) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra.
Qed.

Variables S q G : R.  (* the light's slope, the step's begin, the ground's height *)
Let P := real_height.
Let h := x shared.
Let i := x inverse.
Hypotheses (S0 : 0 < S) (q0 : 0 < q <= 1048576) (G_in : 0 <= G <= 65535).
Hypotheses (light_near : Rabs (x light - S) <= 101 / 100 * u * S) (inverse_near : Rabs (i - / q) <= 101 / 100 * u * /
  q).
Hypotheses (h_is : computed x height h).
Definition least_around : Q := 75 # 167772160.

(* The computed difference and slope. *)
Lemma slope_near s : computed x (slope_of (Given shared 0)) s -> exists d,
  Rabs (d - (x bound - h)) <= u * Rabs (x bound - h) + 4 * h32 /\ Rabs (s * q - d) <= 203 / 100 * u * Rabs d + tiny' /\
  (0 < s -> - 2 * h32 < x bound - h).
Proof.
  intros C. assert (I := Rinv_0_lt_compat _ (proj1 q0)).
  assert (E : Rabs (i * q - 1) <= 101 / 100 * u).
  { replace (i * q - 1) with ((i - / q) * q) by (field; lra). rewrite Rabs_mult, (Rabs_pos_eq q) by lra.
    assert (H := Rmult_le_compat_r q _ _ ltac:(lra) inverse_near).
    replace (101 / 100 * u * / q * q) with (101 / 100 * u) in H by (field; lra). lra. }
  assert (positive : 0 < s -> - 2 * h32 < x bound - h).
  { intros s0. inversion C as [ | | | | | | | | ? ? j d j' d' ? Cj Cd Sj Sd R | ]; subst. apply given32_is in Cj.
    subst j.
    inversion Cd as [ | | | | | | | ? ? b k b' k' ? Cb Ck Sb Sk R' | | ]; subst. apply given32_is in Cb, Ck. subst b k.
    assert (i0 : 0 <= i) by (apply between in E; destruct (Rle_dec 0 i); [lra | exfalso; assert (i * q < 0) by nra;
      lra]).
    apply seen32_positive in Sj as [_ J]. specialize (J i0). apply rounds32_positive in R as [R _]. specialize (R s0).
    assert (d0 : 0 < d') by (destruct (Rlt_or_le 0 d'); [assumption | exfalso; assert (0 <= j' * - d') by (apply
      Rmult_le_pos; lra); lra]).
    apply seen32_positive in Sd as [D _]. specialize (D d0). apply rounds32_positive in R' as [R' _]. specialize (R' D).
    apply seen32_near in Sb, Sk. fold h in Sk. apply between in Sb, Sk. lra. }
  destruct (step32_mul _ _ _ _ C) as (j & d & Cj & Cd & N1). apply given32_is in Cj. subst j. fold i in N1.
  destruct (step32_sub _ _ _ _ Cd) as (b & k & Cb & Ck & N2). apply given32_is in Cb, Ck. subst b k. fold h in N2.
  exists d. split; [exact N2 |]. split; [| exact positive]. clear positive C Cd N2.
  replace (s * q - d) with ((s - i * d) * q + (i * q - 1) * d) by ring. eapply Rle_trans; [apply Rabs_triang |].
  rewrite !Rabs_mult, (Rabs_pos_eq q) by lra. assert (M1 := Rmult_le_compat_r q _ _ ltac:(lra) N1).
  rewrite Rabs_mult in M1. assert (M2 := Rmult_le_compat_r _ _ _ (Rabs_pos d) E).
  assert (iq : Rabs i * q <= 1 + 101 / 100 * u).
  { rewrite <- (Rabs_pos_eq q) at 1 by lra. rewrite <- Rabs_mult. apply between in E. apply Rabs_le. lra. }
  assert (M3 := Rmult_le_compat_r _ _ _ (Rabs_pos d) iq). assert (Z := Rabs_pos d).
  assert (e := h32_positive). assert (e1 := h32_below). simpl in e1.
  assert (M4 := Rmult_le_compat_l h32 _ _ ltac:(lra) iq).
  assert (qd := Rmult_le_compat_r _ _ _ Z (proj2 q0)). assert (qd0 : 0 <= q * Rabs d) by (apply Rmult_le_pos; lra).
  assert (M5 : h32 * (q * Rabs d) <= / 10000000000000 * Rabs d).
  { assert (A := Rmult_le_compat _ _ _ _ (Rlt_le _ _ e) qd0 e1 qd). lra. }
  assert (M6 : h32 * q <= h32 * 1048576) by (apply Rmult_le_compat_l; lra). lra.
Qed.

(* A height is off by less than 1/126 unit, or by 2.01 u of how far it is below the ground. *)
Lemma height_off : 0 < G - P -> Rabs (h - P) <= / 126 + 202 / 100 * u * (G - P).
Proof.
  intros D. assert (N := height_near _ h_is). fold P in N. destruct (Rle_dec 0 P) as [p | p].
  - rewrite (Rabs_pos_eq P) in N by lra. lra.
  - rewrite (Rabs_left1 P) in N by lra. lra.
Qed.

Theorem lit_is_above c l s t : computed x (Times c (Given light 0)) l -> computed x (slope_of (Given shared 0)) s ->
  0 <= Q2R c <= 1 - Q2R least_around -> G + / 100 <= x bound -> q <= t -> s < l -> G - P < S * t.
Proof.
  intros Cl Cs Hc bound_in qt H. assert (e := h32_positive). assert (e1 := h32_below). simpl in e1.
  destruct (Rle_dec (G - P) 0) as [D | D].
  { assert (Z : 0 < S * t) by (apply Rmult_lt_0_compat; lra). lra. }
  assert (O := height_off ltac:(lra)). destruct (slope_near _ Cs) as (d & N1 & N2 & _).
  replace (Q2R least_around) with (75 / 10 * u) in Hc by (unfold Q2R, least_around; simpl; lra).
  destruct (step32_times _ _ _ _ Cl) as (y & Cy & N3). apply given32_is in Cy. subst y.
  rewrite (Rabs_pos_eq (Q2R c)) in N3 by lra.
  assert (St := Rmult_le_compat_l S _ _ ltac:(lra) qt). assert (Sq : 0 < S * q) by (apply Rmult_lt_0_compat; lra).
  apply between in O, light_near. assert (light0 : 0 <= x light) by lra.
  assert (cl0 : 0 <= Q2R c * x light) by (apply Rmult_le_pos; lra). rewrite (Rabs_pos_eq (Q2R c * x light)) in N3 by
    lra.
  assert (cl1 := Rmult_le_compat_r (x light) _ _ light0 (proj2 Hc)). apply between in N3.
  assert (hc : h32 * Q2R c <= h32) by (rewrite <- (Rmult_1_r h32) at 2; apply Rmult_le_compat_l; lra).
  assert (lq : l * q <= (1 - 54 / 10 * u) * (S * q) + 4 * h32 * 1048576).
  { assert (L : l <= (1 - 54 / 10 * u) * S + 4 * h32) by lra. assert (M := Rmult_le_compat_r q _ _ ltac:(lra) L).
    assert (hq := Rmult_le_compat_l h32 _ _ ltac:(lra) (proj2 q0)). lra. }
  assert (sl : s * q < l * q) by (apply Rmult_lt_compat_r; lra).
  assert (b : (1 - 203 / 100 * u) * (G - P) + / 500 <= x bound - h) by lra.
  rewrite (Rabs_pos_eq (x bound - h)) in N1 by lra. apply between in N1. assert (d0 : 0 <= d) by lra.
  rewrite (Rabs_pos_eq d) in N2 by lra. apply between in N2. lra.
Qed.

Theorem dark_is_below c m s : computed x (Times c (Given light 0)) m -> computed x (slope_of (Given shared 0)) s ->
  1 + Q2R least_around <= Q2R c <= 2 -> x bound <= G - / 100 -> m < s -> S * q < G - P.
Proof.
  intros Cm Cs Hc bound_in H. assert (e := h32_positive). assert (e1 := h32_below). simpl in e1.
  destruct (slope_near _ Cs) as (d & N1 & N2 & positive).
  replace (Q2R least_around) with (75 / 10 * u) in Hc by (unfold Q2R, least_around; simpl; lra).
  assert (Sq : 0 < S * q) by (apply Rmult_lt_0_compat; lra). apply between in light_near.
  assert (light0 : 0 < x light) by lra.
  assert (m0 : 0 <= m).
  { inversion Cm as [ | | | ? ? p w ? Hp Hw R | | | | | | ]; subst. apply given32_is in Hp. subst p.
    apply seen32_positive in Hw as [_ W]. apply rounds32_positive in R as [_ R]. apply R, Rmult_le_pos; lra. }
  specialize (positive ltac:(lra)).
  destruct (step32_times _ _ _ _ Cm) as (y & Cy & N3). apply given32_is in Cy. subst y.
  rewrite (Rabs_pos_eq (Q2R c)) in N3 by lra.
  assert (cl1 := Rmult_le_compat_r (x light) _ _ ltac:(lra) (proj1 Hc)).
  rewrite (Rabs_pos_eq (Q2R c * x light)) in N3 by lra. apply between in N3.
  assert (hc : h32 * Q2R c <= 2 * h32) by (rewrite (Rmult_comm 2); apply Rmult_le_compat_l; lra).
  assert (mq : (1 + 54 / 10 * u) * (S * q) - 6 * h32 * 1048576 <= m * q).
  { assert (L : (1 + 54 / 10 * u) * S - 6 * h32 <= m) by lra. assert (M := Rmult_le_compat_r q _ _ ltac:(lra) L).
    assert (hq := Rmult_le_compat_l h32 _ _ ltac:(lra) (proj2 q0)). lra. }
  assert (sm : m * q < s * q) by (apply Rmult_lt_compat_r; lra).
  assert (D : 0 < G - P).
  { destruct (Rle_dec (G - P) 0) as [n |]; [exfalso | lra]. assert (N := height_near _ h_is). fold P in N.
    rewrite (Rabs_pos_eq P) in N by lra. apply between in N. lra. }
  assert (O := height_off D). apply between in O.
  assert (b_in : Rabs (x bound - h) <= x bound - h + 4 * h32) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ N1) in b_in. apply between in b_in.
  assert (d_in : Rabs d <= d + 20 * h32) by (apply Rabs_le; lra).
  assert (N2' : Rabs (s * q - d) <= 203 / 100 * u * (d + 20 * h32) + tiny') by lra. apply between in N2'. lra.
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
