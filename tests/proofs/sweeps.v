(* SPDX-License-Identifier: MIT *)
(* sweeps.cl: the ground where a vertex's own ray meets edges, against the vertex's height less or plus a margin (docs/
   numerics.md, 16).
     lit_is_above, dark_is_below   of the next lines, with near_margin: the real ground is below, or above, the ray;
     walked_near                   along the whole ray, walked alone: 24 u of the greatest height and 8 u of the climb.

   Assumed: heights are 0 to H, up to 2^21, each off by one rounding (RasterCopies subtracts the lowest), a ray's climb C is
   up to 2^31 in all; the host rounds shares of an edge and the climb up to it once (set_crossings()); along a ray that is
   walked a share is rounded once and a distance twice; the margin is SWEEP_CROSSING_ERROR (H + C) + SWEEP_LOST at least
   (set_margins() has 1.01 of the first in double, and rounds the sum once), up to 2^31. Denormals may be kept or flushed. In prose: the bounds
   across a strip, 70 u H + 13 u C of the margin's 128 u and 32 u, in which walked_near has room; unevenness; what lit and
   dark mean. *)
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
Lemma kernel_is_enough : (least_of_sizes <= value_of of_sizes /\ (35 # 10) * lost <= (99 # 100) * value_of of_nothing)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_of_sizes (value_of of_sizes).
Print constants.
Definition checked := (lit_is_above, dark_is_below, walked_near, kernel_is_enough).
Print Assumptions checked.
