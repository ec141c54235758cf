(* SPDX-License-Identifier: MIT *)
(* loose: BEAM_ROUNDING also serves the extents of leaves along a light's axes, which need 3.2e-6 of it (leaf_extents.v) *)
(* beam_intersect.clh, parallel_packets.clh, converging_packets.clh: rays against the tree's boxes. A ray is never computed
   to enter a box later, or to leave it earlier, than it does; so no node that it meets is left out.
     enter_is_early, leave_is_late      parallel rays, t = (side - P) / D;
     moved_low_is_low, moved_high_is_high   a side relative to the rays' origin, and moved by `rounding`, is still outside;
     reached_is_near, interval_is_kept  rays from an origin, whose D has met one rounding: t = side / D.

   Assumed: no coordinate exceeds L, at most 2^100; `rounding` is at least 0.9999 of BEAM_ROUNDING L + BEAM_ROUNDING_LEAST (the host rounds
   it twice), and at most L + 2^-98; a quotient is off by 2.5 ulp; a parallel ray's D is at most 2, another's 2 + 3 L (the
   difference of two points). Denormals may be kept or flushed: `rounding` leaves 40 u L + 1e-31 (left), and that over D is
   more than what underflow takes of t (left_is_enough). Here D > 0; where D < 0 all signs turn. In prose: the coordinates of D
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
Definition of_nothing :=
  Const (332307 # 332306998946228968225951765070086144).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation h := h32.
Ltac take_lost C := apply near32 in C; unfold lost32 in C; cbn -[u32 h32 alpha] in C; unfold of_product in C;
  unfold alpha in C; rewrite ?u32_value in C; simpl pow in C.
Section Boxes.
Variable x : nat -> R.
Variables D L : R.
Local Notation computed := (computes32 x).

(* ---- Parallel rays ---- *)
Definition least_factor : Q := 161 # 167772160.
Definition least_rest : Q := 1 # 1298074214633706907132624082305024.  (* 2^-110 *)
Hypotheses (D0 : 0 < D) (inverse_is : x inverse = / D) (L_in : L <= 2 ^ 100).
Hypotheses (low_in : Rabs (x low) <= L) (high_in : Rabs (x high) <= L) (P_in : Rabs (x P) <= L).
Hypotheses (enough : Q2R least_factor * L + Q2R least_rest <= x rounding) (not_much : x rounding <= L + / 2 ^ 98).

Lemma L0 : 0 <= L.
Proof. eapply Rle_trans; [apply Rabs_pos | exact P_in]. Qed.
Lemma enough' : 161 / 10 * u * L + / 2 ^ 110 <= x rounding.
Proof.
  replace (161 / 10 * u) with (Q2R least_factor) by (unfold Q2R, least_factor; simpl; lra).
  replace (/ 2 ^ 110) with (Q2R least_rest) by (unfold Q2R, least_rest; simpl; lra). exact enough.
Qed.

Section Parallel.
Hypothesis D_in : D <= 2.
(* What a computed t is off by; p is a's sum of magnitudes. *)
Lemma t_is_off a p b v : p <= L + x rounding -> Rabs b <= L ->
  Rabs (v - (a * / D - b * / D)) <= (8 * (1 + / 1000000) * u) * (p * / D + Rabs b * / D) +
    / D * (h * (30 + 20 * L)) ->
  Rabs (v - (a - b) * / D) <= / D * x rounding.
Proof.
  intros A B N. assert (I := Rinv_0_lt_compat _ D0). assert (l0 := L0). assert (E := enough'). assert (h0 := h32_powers).
  replace ((a - b) * / D) with (a * / D - b * / D) by ring. eapply Rle_trans; [exact N |].
  replace (8 * (1 + / 1000000) * u * (p * / D + Rabs b * / D) + / D * (h * (30 + 20 * L)))
    with (/ D * (8 * (1 + / 1000000) * u * (p + Rabs b) + h * (30 + 20 * L))) by ring.
  apply Rmult_le_compat_l; [lra |]. assert (hL := Rmult_le_compat_r L _ _ l0 (proj2 (proj1 h0))). lra.
Qed.
Lemma inverse_facts : / 2 <= / D /\ Rabs (x inverse) = / D.
Proof.
  assert (I := Rinv_0_lt_compat _ D0). split; [apply Rinv_le_contravar; lra | rewrite inverse_is; apply Rabs_pos_eq; lra].
Qed.
Ltac off C :=
  destruct inverse_facts as [I2 inv]; rewrite inv in C; rewrite ?inverse_is in C; assert (h0 := h32_powers);
  assert (l0 := L0); assert (E := enough'); assert (hh := Rmult_le_compat_r (/ D) _ _ ltac:(lra) (proj2 (proj2 h0)));
  assert (hI : h * / 2 <= h * / D) by (apply Rmult_le_compat_l; lra);
  assert (hL : h * L * / 2 <= h * L * / D) by (apply Rmult_le_compat_l; [apply Rmult_le_pos; lra | lra]);
  assert (hL0 : 0 <= h * L) by (apply Rmult_le_pos; lra);
  assert (hP := Rmult_le_compat_l h _ _ ltac:(lra) P_in).

Theorem enter_is_early v t : computed enter v -> x low <= x P + t * D -> v <= t.
Proof.
  intros C H. take_lost C. off C.
  assert (S : Rabs (x low - x rounding) <= L + x rounding).
  { eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, (Rabs_pos_eq (x rounding)) by lra. lra. }
  assert (hS := Rmult_le_compat_l h _ _ ltac:(lra) S). assert (hr := Rmult_le_compat_l h _ _ ltac:(lra) not_much).
  assert (N := t_is_off (x low - x rounding) _ (x P) v S P_in).
  assert (Z1 : 0 <= / D * Rabs (x low - x rounding)) by (apply Rmult_le_pos; [lra | apply Rabs_pos]).
  assert (Z2 : 0 <= / D * Rabs (x P)) by (apply Rmult_le_pos; [lra | apply Rabs_pos]).
  assert (F : Rabs (v - (x low - x rounding - x P) * / D) <= / D * x rounding).
  { apply N. replace ((x low - x rounding) * / D - x P * / D) with (/ D * (x low - x rounding) - x P * / D) by ring. lra. }
  apply between in F.
  assert (t_is : (x low - x P) * / D <= t).
  { replace t with (t * D * / D) by (field; lra). apply Rmult_le_compat_r; lra. }
  lra.
Qed.

Theorem leave_is_late v t : computed leave v -> x P + t * D <= x high -> t <= v.
Proof.
  intros C H. take_lost C. off C. rewrite (Rabs_pos_eq (x rounding)) in C by lra.
  assert (S : Rabs (x high) + x rounding <= L + x rounding) by lra.
  assert (hS := Rmult_le_compat_l h _ _ ltac:(lra) high_in). assert (hr := Rmult_le_compat_l h _ _ ltac:(lra) not_much).
  assert (N := t_is_off (x high + x rounding) _ (x P) v S P_in).
  assert (Z1 : 0 <= / D * Rabs (x high)) by (apply Rmult_le_pos; [lra | apply Rabs_pos]).
  assert (Z2 : 0 <= / D * Rabs (x P)) by (apply Rmult_le_pos; [lra | apply Rabs_pos]).
  assert (Z3 : 0 <= / D * x rounding) by (apply Rmult_le_pos; lra).
  assert (F : Rabs (v - (x high + x rounding - x P) * / D) <= / D * x rounding) by (apply N; lra).
  apply between in F.
  assert (t_is : t <= (x high - x P) * / D).
  { replace t with (t * D * / D) by (field; lra). apply Rmult_le_compat_r; lra. }
  lra.
Qed.
End Parallel.

(* ---- Rays from an origin ---- *)
Hypotheses (origin_in : Rabs (x origin) <= L).
Hypothesis more_than_enough : 66 * u * L + 99 / 100 * / 10 ^ 30 <= x rounding.
Definition left := 40 * u * L + / 10 ^ 31.

Theorem moved_low_is_low v : computed moved_low v -> v + left <= x low - x origin.
Proof.
  intros C. take_lost C. assert (l0 := L0). assert (E := more_than_enough). rewrite (Rabs_pos_eq (x rounding)) in C by lra.
  assert (T := Rabs_triang (x low) (- x origin)). rewrite Rabs_Ropp in T.
  assert (h0 := h32_powers). apply between in C. unfold Rminus, left in *. lra.
Qed.
Theorem moved_high_is_high v : computed moved_high v -> x high - x origin + left <= v.
Proof.
  intros C. take_lost C. assert (l0 := L0). assert (E := more_than_enough). rewrite (Rabs_pos_eq (x rounding)) in C by lra.
  assert (T := Rabs_triang (x high) (- x origin)). rewrite Rabs_Ropp in T.
  assert (h0 := h32_powers). apply between in C. unfold Rminus, left in *. lra.
Qed.

Definition of_underflow := h * (3 + 3 * / D + 2 * Rabs (x side)).
Theorem reached_is_near v : x rounded_inverse = / D -> computed reached v ->
  Rabs (v - x side / D) <= 701 / 100 * u * Rabs (x side / D) + of_underflow.
Proof.
  intros I C. take_lost C. rewrite I in C. assert (J := Rinv_0_lt_compat _ D0). assert (h0 := h32_powers).
  replace (/ D * x side) with (x side / D) in C by (unfold Rdiv; ring).
  replace (Rabs (/ D) * Rabs (x side)) with (Rabs (x side / D)) in C
    by (rewrite <- Rabs_mult; f_equal; unfold Rdiv; ring).
  rewrite (Rabs_pos_eq (/ D)) in C by lra.
  assert (Z := Rabs_pos (x side / D)). assert (hs : 0 <= h * Rabs (x side)) by (apply Rmult_le_pos; [lra | apply Rabs_pos]).
  assert (hJ : 0 <= h * / D) by (apply Rmult_le_pos; lra). unfold of_underflow. lra.
Qed.
Theorem left_is_enough : D <= 2 + 3 * L -> Rabs (x side) <= 4 * L + / 2 ^ 97 -> of_underflow + 2 * h <= 9 / 10 * (left * / D).
Proof.
  intros D_in side_in. unfold of_underflow, left. assert (l0 := L0). assert (h0 := h32_powers).
  assert (J := Rinv_0_lt_compat _ D0).
  assert (hs := Rmult_le_compat_l h _ _ ltac:(lra) side_in).
  assert (hl := Rmult_le_compat_r L _ _ l0 (proj2 (proj1 h0))).
  assert (one : D * / D = 1) by (field; lra).
  assert (A : (h * (5 + 2 * (4 * L + / 2 ^ 97))) * D <= 8 / 10 * (40 * u * L + / 10 ^ 31)).
  { assert (A1 : h * (5 + 2 * (4 * L + / 2 ^ 97)) <= / 2 ^ 126 * (6 + 8 * L)) by (apply Rmult_le_compat; lra).
    assert (A2 : h * (5 + 2 * (4 * L + / 2 ^ 97)) * D <= / 2 ^ 126 * (6 + 8 * L) * (2 + 3 * L))
      by (apply Rmult_le_compat; try lra; apply Rmult_le_pos; lra).
    assert (LL := Rmult_le_compat_r L _ _ l0 L_in). lra. }
  assert (A' := Rmult_le_compat_r (/ D) _ _ ltac:(lra) A).
  replace (h * (5 + 2 * (4 * L + / 2 ^ 97)) * D * / D) with (h * (5 + 2 * (4 * L + / 2 ^ 97))) in A' by (field; lra).
  assert (B : 3 * h * / D <= / 10 * (/ 10 ^ 31) * / D) by (apply Rmult_le_compat_r; lra).
  assert (C : 0 <= L * / D) by (apply Rmult_le_pos; lra). lra.
Qed.
End Boxes.

(* t lies between begin and end, whose sides are `left` outside of where it meets the box, so first and last at least w and w'
   before and after t; they are computed as b and e; s is the computed b LESS_THAN_ONE. (A begin of 0 is computed exactly.) *)
Definition least_less : Q := 151 # 167772160.
Theorem interval_is_kept t first last b e s one w w' l l' :
  0 <= first -> first + w <= t -> t + w' <= last ->
  Rabs (b - first) <= 701 / 100 * u * first + l -> Rabs (e - last) <= 701 / 100 * u * last + l' ->
  0 <= l -> 0 <= l' -> l + l' + 2 * h <= 9 / 10 * (w + w') -> 0 <= w -> 0 <= w' ->
  Q2R one <= 1 - Q2R least_less -> 0 <= Q2R one -> 0 <= b -> s <= (1 + u) * (b * Q2R one) + 2 * h -> s <= e.
Proof.
  intros f0 ft tl Hb He l0 l0' lw w0 w0' Hone one0 b0 Hs.
  replace (Q2R least_less) with (151 / 167772160) in Hone by (unfold Q2R, least_less; simpl; lra).
  apply between in Hb. apply between in He. assert (G := Rmult_le_compat_l b _ _ b0 Hone). lra.
Qed.
Lemma rounding_is_enough : forall L r factor least, 0 <= L -> 4 / 1000000 - / 10 ^ 12 <= factor -> / 10 ^ 30 <= least ->
  9999 / 10000 * (factor * L + least) <= r ->
  Q2R least_factor * L + Q2R least_rest <= r /\ 66 * u * L + 99 / 100 * / 10 ^ 30 <= r.
Proof.
  intros L r factor least l0 f0 n0 r0. assert (G := Rmult_le_compat_r L _ _ l0 f0).
  replace (Q2R least_factor) with (161 / 10 * u) by (unfold Q2R, least_factor; simpl; lra).
  replace (Q2R least_rest) with (/ 2 ^ 110) by (unfold Q2R, least_rest; simpl; lra). split; lra.
Qed.
Definition of_expr e := match e with Const q => q | _ => 0%Q end.
Lemma kernel_is_enough : ((4 # 1000000) - (1 # 10 ^ 12) <= of_expr factor /\ 1 # 10 ^ 30 <= of_expr of_nothing <= 1 # 2 ^ 99)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_less (1 - of_expr less)%Q.
Print constants.
Definition rests := Eval vm_compute in shown least_factor (of_expr factor).
Print rests.
Definition checked := (enter_is_early, leave_is_late, moved_low_is_low, moved_high_is_high, reached_is_near,
  left_is_enough, interval_is_kept, rounding_is_enough, kernel_is_enough).
Print Assumptions checked.
