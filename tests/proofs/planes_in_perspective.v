(* SPDX-License-Identifier: MIT *)
(* triangle_records.clh, set_plane_perspective(): how far 1 / W of a plane at a point of the grid may be from the real one
   (docs/numerics.md, 4):
     rounding, of_quotients  the computed height, from the record's numbers: 8 u L, and 2^-99;
     margin_near             the margin, from its quotients;
     products_near           N . p from the rounded N: delta_np's term of products; delta_np_has_it: what underflow takes;
     determinant_moves       N . a, where a lies anywhere: delta_determinant, with all its roundings;
     in_grid_moves           the same where a lies in the grid, from cross_moves at a's place;
     cross_moves             N . p: delta_np's other terms, from the errors of two sides;
     quotient_moves          what the errors of N . p and det do to their quotient;
     quotients_are_enough    the margin's quotients as they are computed, by over_least, under_most, anywhere_least and in_grid_least,
                             times 1.0085: they have what quotient_moves asks for, by np_has_it and det_has_it.

   Assumed: |X|, |Y| <= reach, whose parts are up to 2^16, the rectangle's side from 1 on (a bin has a texel); corners are off by
   `error` and error_w, 2^-90 at least (projection.v); a side is no longer than 4 reach times its rho (edge_functions.v,
   rho_has); a quotient is off by 2.5 ulp and by 2^-126; safe_determinant is more than a quarter of det, which the kernel asks,
   here a fifth. Where a lies in the grid a_w is not negative, and rho_1a, rho_2a and far_reach hold at a's real place, as rho and
   R do over the bins; position_has_it: a_w position_error is as small as e. Denormals may be kept or flushed: what that takes of
   the quotients is less than a 2000th of delta_np and of delta_determinant, and 2^-94, which PLANE_NEAR has. In prose: the
   point's height, 2 L height_error. Overflow: no height is certain where the margin is infinite. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition a_z := 2%nat.
Definition b_x := 3%nat.
Definition b_y := 4%nat.
Definition b_z := 5%nat.
Definition c_x := 6%nat.
Definition c_y := 7%nat.
Definition c_z := 8%nat.
Definition X := 9%nat.
Definition Y := 10%nat.
Definition side := 11%nat.
Definition error := 12%nat.
Definition error_w := 13%nat.
Definition point_error := 14%nat.
Definition height_error := 15%nat.
Definition orientation := 16%nat.
Definition quotient_1 := 17%nat.
Definition quotient_2 := 18%nat.
Definition quotient_3 := 19%nat.
Definition greater_1 := 20%nat.
Definition greater_2 := 21%nat.
Definition greater_3 := 22%nat.
Definition greater_4 := 23%nat.
Definition greater_5 := 24%nat.
Definition greater_6 := 25%nat.
Definition quotient_4 := 26%nat.
Definition quotient_5 := 27%nat.
Definition quotient_6 := 28%nat.
Definition quotient_7 := 29%nat.
Definition greater_7 := 30%nat.
Definition lesser_1 := 31%nat.
Definition greater_8 := 32%nat.
Definition quotient_8 := 33%nat.
Definition greater_9 := 34%nat.
Definition lesser_2 := 35%nat.
Definition greater_10 := 36%nat.
Definition greater_11 := 37%nat.
Definition greater_12 := 38%nat.
Definition greater_13 := 39%nat.
Definition greater_14 := 40%nat.
Definition quotient_1_over :=
  Fma (Diff b_y a_y) (Diff c_z a_z) (Neg (Mul (Diff b_z a_z) (Diff c_y a_y))).
Definition quotient_1_under :=
  Fma quotient_1_over (Given a_x 0) (Fma (Fma (Diff b_z a_z) (Diff c_x a_x) (Mul (Neg (Diff b_x a_x)) (Diff c_z
    a_z))) (Given a_y 0) (Mul (Fma (Diff b_x a_x) (Diff c_y a_y) (Mul (Neg (Diff b_y a_y)) (Diff c_x a_x))) (Given
    a_z 0))).
Definition quotient_2_over :=
  Fma (Diff b_z a_z) (Diff c_x a_x) (Mul (Neg (Diff b_x a_x)) (Diff c_z a_z)).
Definition quotient_2_under :=
  quotient_1_under.
Definition quotient_3_over :=
  Fma (Diff b_x a_x) (Diff c_y a_y) (Mul (Neg (Diff b_y a_y)) (Diff c_x a_x)).
Definition quotient_3_under :=
  quotient_2_under.
Definition height :=
  Fma (Given X 0) (Given quotient_1 5) (Fma (Given Y 0) (Given quotient_2 5) (Given quotient_3 5)).
Definition greater_1_one :=
  Abs (Sub (Diff b_x a_x) (Times (0 # 1) (Diff b_z a_z))).
Definition greater_1_other :=
  Abs (Sub (Diff b_x a_x) (Mul (Given side 0) (Diff b_z a_z))).
Definition greater_2_one :=
  Abs (Sub (Diff b_y a_y) (Times (0 # 1) (Diff b_z a_z))).
Definition greater_2_other :=
  Abs (Sub (Diff b_y a_y) (Mul (Given side 0) (Diff b_z a_z))).
Definition greater_3_one := Given greater_1 0.
Definition greater_3_other := Given greater_2 0.
Definition greater_4_one :=
  Abs (Sub (Diff c_x a_x) (Times (0 # 1) (Diff c_z a_z))).
Definition greater_4_other :=
  Abs (Sub (Diff c_x a_x) (Mul (Given side 0) (Diff c_z a_z))).
Definition greater_5_one :=
  Abs (Sub (Diff c_y a_y) (Times (0 # 1) (Diff c_z a_z))).
Definition greater_5_other :=
  Abs (Sub (Diff c_y a_y) (Mul (Given side 0) (Diff c_z a_z))).
Definition greater_6_one := Given greater_4 0.
Definition greater_6_other := Given greater_5 0.
Definition quotient_4_over :=
  Add (Add (Add (Times (1 # 1237940039285380274899124224) (Add (Add (Given point_error 0) (Given side 0)) (Const (1
    # 1)))) (Times (2 # 1) (Add (Add (Mul (Add (Add (Add (Given error 0) (Mul (Add (Given point_error 0) (Given side
    0)) (Given error_w 0))) (Given error 0)) (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0)))
    (Add (Given greater_3 0) (Mul (Abs (Diff b_z a_z)) (Given point_error 0)))) (Mul (Add (Add (Add (Given error 0)
    (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0))) (Given error 0)) (Mul (Add (Given
    point_error 0) (Given side 0)) (Given error_w 0))) (Add (Given greater_6 0) (Mul (Abs (Diff c_z a_z)) (Given
    point_error 0))))) (Mul (Add (Add (Add (Given error 0) (Mul (Add (Given point_error 0) (Given side 0)) (Given
    error_w 0))) (Given error 0)) (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0))) (Add (Add (Add
    (Given error 0) (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0))) (Given error 0)) (Mul (Add
    (Given point_error 0) (Given side 0)) (Given error_w 0))))))) (Times (1 # 4194304) (Add (Add (Abs (Mul (Diff b_x
    a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x)))) (Add (Mul (Add (Abs (Mul (Diff b_x a_x) (Diff
    c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_x a_x)))) (Add (Given point_error 0) (Given side 0))) (Mul (Add (Abs
    (Mul (Diff b_y a_y) (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_y a_y)))) (Add (Given point_error 0)
    (Given side 0))))))) (Mul (Add (Abs (Given quotient_3 5)) (Add (Mul (Abs (Given quotient_1 5)) (Add (Given
    point_error 0) (Given side 0))) (Mul (Abs (Given quotient_2 5)) (Add (Given point_error 0) (Given side 0)))))
    (Add (Add (Add (Add (Add (Mul (Abs quotient_1_over) (Given error 0)) (Mul (Abs quotient_2_over) (Given error
    0))) (Mul (Abs quotient_3_over) (Given error_w 0))) (Times (1 # 4194304) (Add (Abs (Mul quotient_3_over (Given
    a_z 0))) (Add (Abs (Mul quotient_1_over (Given a_x 0))) (Abs (Mul quotient_2_over (Given a_y 0))))))) (Times (1
    # 1237940039285380274899124224) (Add (Add (Abs (Given a_z 0)) (Add (Abs (Given a_x 0)) (Abs (Given a_y 0))))
    (Const (1 # 1))))) (Add (Mul (Add (Add (Abs (Given a_z 0)) (Given error_w 0)) (Add (Add (Abs (Given a_x 0))
    (Given error 0)) (Add (Abs (Given a_y 0)) (Given error 0)))) (Add (Add (Mul (Add (Abs (Diff b_z a_z)) (Add (Abs
    (Diff b_x a_x)) (Abs (Diff b_y a_y)))) (Add (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given
    error_w 0))) (Mul (Add (Abs (Diff c_z a_z)) (Add (Abs (Diff c_x a_x)) (Abs (Diff c_y a_y)))) (Add (Add (Add
    (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0)))) (Times (2 # 1) (Mul (Add (Add (Add
    (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0)) (Add (Add (Add (Given error 0) (Given
    error 0)) (Given error_w 0)) (Given error_w 0)))))) (Times (1 # 4194304) (Add (Add (Mul (Add (Abs (Given a_x 0))
    (Given error 0)) (Add (Abs (Mul (Diff b_y a_y) (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_y a_y))))) (Mul
    (Add (Abs (Given a_y 0)) (Given error 0)) (Add (Abs (Mul (Diff b_x a_x) (Diff c_z a_z))) (Abs (Mul (Diff b_z
    a_z) (Diff c_x a_x)))))) (Mul (Add (Abs (Given a_z 0)) (Given error_w 0)) (Add (Abs (Mul (Diff b_x a_x) (Diff
    c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x)))))))))).
Definition quotient_4_under :=
  Sub (Abs quotient_3_under) (Times (4236247 # 4194304) (Add (Add (Add (Add (Add (Mul (Abs quotient_1_over) (Given
    error 0)) (Mul (Abs quotient_2_over) (Given error 0))) (Mul (Abs quotient_3_over) (Given error_w 0))) (Times (1
    # 4194304) (Add (Abs (Mul quotient_3_over (Given a_z 0))) (Add (Abs (Mul quotient_1_over (Given a_x 0))) (Abs
    (Mul quotient_2_over (Given a_y 0))))))) (Times (1 # 1237940039285380274899124224) (Add (Add (Abs (Given a_z 0))
    (Add (Abs (Given a_x 0)) (Abs (Given a_y 0)))) (Const (1 # 1))))) (Add (Mul (Add (Add (Abs (Given a_z 0)) (Given
    error_w 0)) (Add (Add (Abs (Given a_x 0)) (Given error 0)) (Add (Abs (Given a_y 0)) (Given error 0)))) (Add (Add
    (Mul (Add (Abs (Diff b_z a_z)) (Add (Abs (Diff b_x a_x)) (Abs (Diff b_y a_y)))) (Add (Add (Add (Given error 0)
    (Given error 0)) (Given error_w 0)) (Given error_w 0))) (Mul (Add (Abs (Diff c_z a_z)) (Add (Abs (Diff c_x a_x))
    (Abs (Diff c_y a_y)))) (Add (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0))))
    (Times (2 # 1) (Mul (Add (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0)) (Add
    (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0)))))) (Times (1 # 4194304) (Add
    (Add (Mul (Add (Abs (Given a_x 0)) (Given error 0)) (Add (Abs (Mul (Diff b_y a_y) (Diff c_z a_z))) (Abs (Mul
    (Diff b_z a_z) (Diff c_y a_y))))) (Mul (Add (Abs (Given a_y 0)) (Given error 0)) (Add (Abs (Mul (Diff b_x a_x)
    (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_x a_x)))))) (Mul (Add (Abs (Given a_z 0)) (Given error_w 0))
    (Add (Abs (Mul (Diff b_x a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x)))))))))).
Definition quotient_5_over :=
  Add (Abs quotient_1_over) (Abs quotient_2_over).
Definition quotient_5_under :=
  quotient_4_under.
(* margin: where add(8.271806125530277e-25, mul(add(add(add(quotient_4, mul(quotient_5, point_error)),
   mul(add(abs(quotient_3), add(mul(abs(quotient_1), add(point_error, side)), mul(abs(quotient_2), add(point_error,
   side)))), 4.76837158203125e-07)), mul(add(abs(quotient_3), add(mul(abs(quotient_1), add(point_error, side)),
   mul(abs(quotient_2), add(point_error, side)))), mul(2.0, height_error))), 1.0099999904632568)) <
   mul(add(abs(quotient_3), add(mul(abs(quotient_1), add(point_error, side)), mul(abs(quotient_2), add(point_error,
   side)))), 0.5) *)
(* margin: where mul(quotient_3_under, orientation) > 0.0 *)
(* margin: where quotient_5_under > mul(abs(quotient_3_under), 0.25) *)
Definition margin :=
  Add (Const (1 # 1208925819614629174706176)) (Times (4236247 # 4194304) (Add (Add (Add (Given quotient_4 5) (Mul
    (Given quotient_5 5) (Given point_error 0))) (Times (1 # 2097152) (Add (Abs (Given quotient_3 5)) (Add (Mul (Abs
    (Given quotient_1 5)) (Add (Given point_error 0) (Given side 0))) (Mul (Abs (Given quotient_2 5)) (Add (Given
    point_error 0) (Given side 0))))))) (Mul (Add (Abs (Given quotient_3 5)) (Add (Mul (Abs (Given quotient_1 5))
    (Add (Given point_error 0) (Given side 0))) (Mul (Abs (Given quotient_2 5)) (Add (Given point_error 0) (Given
    side 0))))) (Times (2 # 1) (Given height_error 0))))).
Definition quotient_6_over :=
  Add (Given error 0) (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0)).
Definition quotient_6_under :=
  Diff a_z error_w.
Definition quotient_7_over := Given a_x 0.
Definition quotient_7_under := Given a_z 0.
Definition greater_7_one := Given quotient_7 5.
Definition greater_7_other := Given side 0.
Definition lesser_1_one :=
  Const (0 # 1).
Definition lesser_1_other := Given quotient_7 5.
Definition greater_8_one :=
  Abs (Sub (Diff b_x a_x) (Mul (Given greater_7 0) (Diff b_z a_z))).
Definition greater_8_other :=
  Abs (Sub (Diff b_x a_x) (Mul (Given lesser_1 0) (Diff b_z a_z))).
Definition quotient_8_over := Given a_y 0.
Definition quotient_8_under := Given a_z 0.
Definition greater_9_one := Given quotient_8 5.
Definition greater_9_other := Given side 0.
Definition lesser_2_one :=
  lesser_1_one.
Definition lesser_2_other := Given quotient_8 5.
Definition greater_10_one :=
  Abs (Sub (Diff b_y a_y) (Mul (Given greater_9 0) (Diff b_z a_z))).
Definition greater_10_other :=
  Abs (Sub (Diff b_y a_y) (Mul (Given lesser_2 0) (Diff b_z a_z))).
Definition greater_11_one := Given greater_8 0.
Definition greater_11_other := Given greater_10 0.
Definition greater_12_one :=
  Abs (Sub (Diff c_x a_x) (Mul (Given greater_7 0) (Diff c_z a_z))).
Definition greater_12_other :=
  Abs (Sub (Diff c_x a_x) (Mul (Given lesser_1 0) (Diff c_z a_z))).
Definition greater_13_one :=
  Abs (Sub (Diff c_y a_y) (Mul (Given greater_9 0) (Diff c_z a_z))).
Definition greater_13_other :=
  Abs (Sub (Diff c_y a_y) (Mul (Given lesser_2 0) (Diff c_z a_z))).
Definition greater_14_one := Given greater_12 0.
Definition greater_14_other := Given greater_13 0.
Definition in_grid :=
  Mul (Add (Given a_z 0) (Given error_w 0)) (Add (Times (1 # 4194304) (Add (Add (Abs (Mul (Diff b_x a_x) (Diff c_y
    a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x)))) (Add (Mul (Add (Abs (Mul (Diff b_x a_x) (Diff c_z a_z))) (Abs
    (Mul (Diff b_z a_z) (Diff c_x a_x)))) (Add (Add (Given point_error 0) (Given side 0)) (Given quotient_6 5)))
    (Mul (Add (Abs (Mul (Diff b_y a_y) (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_y a_y)))) (Add (Add (Given
    point_error 0) (Given side 0)) (Given quotient_6 5)))))) (Times (2 # 1) (Add (Add (Mul (Add (Add (Add
    quotient_6_over (Given error 0)) (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0))) (Mul (Add
    (Given error_w 0) (Given error_w 0)) (Given quotient_6 5))) (Add (Given greater_11 0) (Mul (Abs (Diff b_z a_z))
    (Given quotient_6 5)))) (Mul (Add (Add (Add quotient_6_over (Given error 0)) (Mul (Add (Given point_error 0)
    (Given side 0)) (Given error_w 0))) (Mul (Add (Given error_w 0) (Given error_w 0)) (Given quotient_6 5))) (Add
    (Given greater_14 0) (Mul (Abs (Diff c_z a_z)) (Given quotient_6 5))))) (Mul (Add (Add (Add quotient_6_over
    (Given error 0)) (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0))) (Mul (Add (Given error_w 0)
    (Given error_w 0)) (Given quotient_6 5))) (Add (Add (Add quotient_6_over (Given error 0)) (Mul (Add (Given
    point_error 0) (Given side 0)) (Given error_w 0))) (Mul (Add (Given error_w 0) (Given error_w 0)) (Given
    quotient_6 5))))))).
(* where mul(quotient_3_under, orientation) > 0.0 *)
(* where quotient_5_under > mul(abs(quotient_3_under), 0.25) *)
(* where margin < mul(add(abs(quotient_3), add(mul(abs(quotient_1), add(point_error, side)), mul(abs(quotient_2),
   add(point_error, side)))), 0.5) *)
(* end: from the kernels *)

Section Plane.
Variable x : nat -> R.
Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation h := h32.

(* ---- The height's roundings ---- *)
Let reach := x point_error + x side.
Hypotheses (X_in : Rabs (x X) <= reach) (Y_in : Rabs (x Y) <= reach).
Hypotheses (side_in : 1 <= x side <= 2 ^ 16) (point_error_in : 0 <= x point_error <= 2 ^ 16).

(* L: the sum of the magnitudes that the margin multiplies with its constant. *)
Definition of_largest := match margin with Add _ (Times _ (Add (Add _ (Times c _)) _)) => c | _ => 0%Q end.
Definition largest := match margin with Add _ (Times _ (Add (Add _ (Times _ l)) _)) => l | _ => Const 0 end.
Definition inflation := match margin with Add _ (Times i _) => i | _ => 0%Q end.
Definition of_nothing : Q := match margin with Add (Const c) _ => c | _ => 0%Q end.
Lemma margin_is : margin = Add (Const of_nothing) (Times inflation
  (Add (Add (Add (Given quotient_4 5) (Mul (Given quotient_5 5) (Given point_error 0))) (Times of_largest largest))
       (Mul largest (Times 2 (Given height_error 0))))).
Proof. reflexivity. Qed.
(* The margin rounds five times more than `largest`. *)
Definition constant : Q := of_largest * inflation * (1 - (6 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (rate u32Q height largest / (inflation * (1 - (6 # 2 ^ 24))))%Q.

Lemma signs : Rabs (x point_error) = x point_error /\ Rabs (x side) = x side.
Proof. split; apply Rabs_pos_eq; lra. Qed.
Lemma products : permanent x height <= permanent x largest.
Proof.
  destruct signs as [P S]. cbv [height largest margin permanent]. rewrite P, S.
  assert (G1 := Rmult_le_compat_r _ _ _ (Rabs_pos (x quotient_1)) X_in).
  assert (G2 := Rmult_le_compat_r _ _ _ (Rabs_pos (x quotient_2)) Y_in). unfold reach in *. lra.
Qed.

(* What underflow takes: coordinates are up to 2^17, slopes and heights up to L, as the reach is 1 at least. *)
Let L := real x largest.
Definition is_place i := (Nat.eqb i X || Nat.eqb i Y || Nat.eqb i point_error || Nat.eqb i side)%bool.
Definition caps i : polynomial := if is_place i then number (2 ^ 17) else line 0 1.
Definition rest_of_height := line (1 # 2 ^ 100) (1 # 2 ^ 100).
Lemma inputs_in : Rabs (x quotient_1) <= L /\ Rabs (x quotient_2) <= L /\ Rabs (x quotient_3) <= L.
Proof.
  unfold L. cbv [largest margin real]. assert (S1 := Rabs_pos (x quotient_1)). assert (S2 := Rabs_pos (x quotient_2)).
  assert (Z := Rabs_pos (x quotient_3)).
  assert (P1 := Rmult_le_compat_l _ _ _ S1 (proj1 side_in)). assert (P2 := Rmult_le_compat_l _ _ _ S2 (proj1 side_in)).
  assert (P3 := Rmult_le_pos _ _ S1 (proj1 point_error_in)). assert (P4 := Rmult_le_pos _ _ S2 (proj1 point_error_in)). lra.
Qed.
Lemma power_17 : Q2R (2 ^ 17) = 2 ^ 17.
Proof. unfold Q2R. simpl. lra. Qed.
Ltac in_caps := cbn -[Q2R Rabs pow Qpower]; rewrite ?Q2R_0', ?Q2R_1, ?power_17; repeat split; simpl in *; lra.
Theorem rounding v s : computes32 x height v -> computes32 x largest s ->
  Rabs (v - real x height) <= Q2R constant * s + at_size L rest_of_height.
Proof.
  intros Cv Cs. destruct inputs_in as (I1 & I2 & I3). destruct signs as [P S].
  assert (L0 : 0 <= L) by (assert (Z := Rabs_pos (x quotient_3)); lra).
  assert (X1 := X_in). assert (Y1 := Y_in). unfold reach in X1, Y1. clearbody L.
  assert (E := error_but_taken x (all h32Q) height largest constant v s (all_may_lose x) ltac:(vm_compute; reflexivity)
    ltac:(vm_compute; reflexivity) products ltac:(cbv [largest margin real permanent]; rewrite P, S; reflexivity) Cv Cs).
  assert (T1 := lost_is_at_most x (all h32Q) caps (fun _ _ => nil) L (line (1 # 2 ^ 101) (1 # 2 ^ 101)) height
    (all_may_lose x) L0 ltac:(in_caps) ltac:(vm_compute; reflexivity)).
  assert (T2 := lost_is_at_most x (all h32Q) caps (fun _ _ => nil) L (line (1 # 2 ^ 101) (1 # 2 ^ 101)) largest
    (all_may_lose x) L0 ltac:(in_caps) ltac:(vm_compute; reflexivity)).
  fold (taken x (all h32Q) height) in T1. fold (taken x (all h32Q) largest) in T2.
  assert (c : 0 <= Q2R constant <= / 2).
  { split; [rewrite <- Q2R_0' | replace (/ 2) with (Q2R (1 # 2)) by (unfold Q2R; simpl; lra)]; apply Qle_Rle;
    apply Qle_bool_iff; vm_compute; reflexivity. }
  assert (T0 : 0 <= taken x (all h32Q) largest)
    by (apply lost_positive; [apply bpow_ge_0 | apply bpow_ge_0 | exact (keeps_range x _ (all_may_lose x))]).
  assert (cT := Rmult_le_compat_r _ _ _ T0 (proj2 c)).
  set (k := Q2R constant) in *. clearbody k. unfold rest_of_height. revert T1 T2.
  cbn -[taken Q2R height largest]. unfold Q2R. simpl Qnum. simpl Qden. intros. lra.
Qed.
(* The record's numbers are off by 2^-126 from quotients, as underflow may have it: so much more is a height. *)
Lemma of_quotients a b c : Rabs (x quotient_1 - a) <= h -> Rabs (x quotient_2 - b) <= h -> Rabs (x quotient_3 - c) <= h ->
  Rabs (real x height - (x X * a + x Y * b + c)) <= / 2 ^ 100.
Proof.
  intros A B C. assert (h1 := h32_below). assert (h0 := h32_positive). cbn.
  assert (PA := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) X_in A).
  assert (PB := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Y_in B). rewrite <- Rabs_mult in PA, PB.
  assert (R1 : reach * h <= 2 ^ 17 * h) by (apply Rmult_le_compat_r; unfold reach; simpl in *; lra).
  replace (x X * x quotient_1 + (x Y * x quotient_2 + x quotient_3) - (x X * a + x Y * b + c)) with
    (x X * (x quotient_1 - a) + (x Y * (x quotient_2 - b) + (x quotient_3 - c))) by ring.
  apply between in PA, PB, C. apply Rabs_le. simpl in *. lra.
Qed.
(* The margin as it is computed: M is the greatest of the quotients; height_error is up to 1. *)
Definition caps_of_margin i := if Nat.eqb i height_error then number 1 else caps i.
Theorem margin_near M v : 0 <= M -> within x (fun i => at_size M (caps_of_margin i)) (fun _ _ => 0) margin ->
  computes32 x margin v -> Rabs (v - real x margin) <= alpha u32 (roundings margin) * permanent x margin +
    at_size M (line (1 # 2 ^ 96) (1 # 2 ^ 90)).
Proof.
  intros M0 W C. exact (near_at_size x caps_of_margin (fun _ _ => nil) M (line (1 # 2 ^ 96) (1 # 2 ^ 90)) margin v M0
    ltac:(vm_compute; reflexivity) W C).
Qed.

(* ---- N . p: delta_np's terms of products, and UNDERFLOW ---- *)
Definition of_products := match quotient_4_over with Add (Add _ (Times c _)) _ => c | _ => 0%Q end.
Definition sizes := match quotient_4_over with Add (Add _ (Times _ s)) _ => s | _ => Const 0 end.
Definition underflow_term : Q := match quotient_4_over with Add (Add (Add (Times c _) _) _) _ => c | _ => 0%Q end.
Lemma term_is : match quotient_4_over with Add (Add (Add (Times _ s) _) _) _ => s | _ => Const 0 end =
  Add (Add (Given point_error 0) (Given side 0)) (Const 1).
Proof. reflexivity. Qed.
(* What underflow takes of a height, of its quotients and of the margin, and in proportion to L. *)
Lemma kernel_is_enough : (2 * (1 # 2 ^ 100) + (1 # 2 ^ 96) + (1 # 2 ^ 94) <= of_nothing * (1 - (1 # 2 ^ 20)) /\
  least_bound + (1 # 2 ^ 89) <= of_largest /\ 1 # 2 ^ 90 <= underflow_term)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.

Variable S : R.  (* no side is longer *)
Let short i j := Rabs (x i - x j) <= S.
Hypotheses (x1_in : short b_x a_x) (y1_in : short b_y a_y) (w1_in : short b_z a_z).
Hypotheses (x2_in : short c_x a_x) (y2_in : short c_y a_y) (w2_in : short c_z a_z).
Definition normal_loses := h * (20 * S + 8).
Lemma normals_near e v : List.In e (quotient_1_over :: quotient_2_over :: quotient_3_over :: nil)%list -> computes32 x e v ->
  Rabs (v - real x e) <= (1 + / 1048576) * / 4194304 * permanent x e + normal_loses.
Proof.
  intros I C. assert (S0 : 0 <= S) by (eapply Rle_trans; [apply Rabs_pos | exact x1_in]).
  destruct h32_powers as [h0 hh]. simpl in h0, hh.
  assert (N := near32 x e v C). assert (K : roundings e = 4%nat) by (destruct I as [<- | [<- | [<- | []]]]; reflexivity).
  rewrite K in N. assert (G := Rmult_le_compat_r _ _ _ (permanent_positive x e) four_roundings).
  assert (T : lost32 x e <= normal_loses).
  { assert (times : forall i j, short i j -> 0 <= h * Rabs (x i - x j) <= h * S).
    { intros i j H. split; [apply Rmult_le_pos; [lra | apply Rabs_pos] | apply Rmult_le_compat_l; [lra | exact H]]. }
    assert (T1 := times _ _ x1_in). assert (T2 := times _ _ y1_in). assert (T3 := times _ _ w1_in).
    assert (T4 := times _ _ x2_in). assert (T5 := times _ _ y2_in). assert (T6 := times _ _ w2_in).
    unfold normal_loses, lost32. destruct I as [<- | [<- | [<- | []]]]; cbn -[u32 h32]; unfold of_product, alpha;
      rewrite ?u32_value; simpl pow; lra. }
  lra.
Qed.
Theorem products_near n_x n_y n_w :
  computes32 x quotient_1_over n_x -> computes32 x quotient_2_over n_y -> computes32 x quotient_3_over n_w ->
  Rabs ((n_x * x X + n_y * x Y + n_w) -
        (real x quotient_1_over * x X + real x quotient_2_over * x Y + real x quotient_3_over)) <=
  (1 + / 1048576) * Q2R of_products * real x sizes + (2 * reach + 1) * normal_loses.
Proof.
  intros C1 C2 C3.
  assert (N1 := normals_near quotient_1_over _ ltac:(cbn; tauto) C1).
  assert (N2 := normals_near quotient_2_over _ ltac:(cbn; tauto) C2).
  assert (N3 := normals_near quotient_3_over _ ltac:(cbn; tauto) C3).
  replace (n_x * x X + n_y * x Y + n_w - (real x quotient_1_over * x X + real x quotient_2_over * x Y +
    real x quotient_3_over)) with ((n_x - real x quotient_1_over) * x X + ((n_y - real x quotient_2_over) * x Y +
    (n_w - real x quotient_3_over))) by ring.
  assert (M1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N1 X_in).
  assert (M2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N2 Y_in). rewrite <- Rabs_mult in M1, M2.
  assert (T1 := Rabs_triang ((n_x - real x quotient_1_over) * x X) ((n_y - real x quotient_2_over) * x Y +
    (n_w - real x quotient_3_over))).
  assert (T2 := Rabs_triang ((n_y - real x quotient_2_over) * x Y) (n_w - real x quotient_3_over)).
  replace (real x sizes) with (permanent x quotient_1_over * reach + permanent x quotient_2_over * reach +
    permanent x quotient_3_over).
  - replace (Q2R of_products) with (/ 4194304) by (unfold Q2R; simpl; lra). lra.
  - unfold reach. cbv [sizes quotient_4_over quotient_1_over quotient_2_over quotient_3_over real permanent].
    rewrite !Rabs_mult. ring.
Qed.
(* By edge_functions.v, rho_has, a side is no longer than 3 reach rho; so a 2000th of delta_np's terms is enough. *)
Theorem delta_np_has_it rho_1 rho_2 e_1 e_2 : S = 4 * reach * (rho_1 + rho_2) -> 0 <= rho_1 -> 0 <= rho_2 ->
  / 2 ^ 90 * reach <= e_1 -> / 2 ^ 90 * reach <= e_2 ->
  (2 * reach + 1) * normal_loses <= / 2000 * (2 * (rho_1 * e_2 + rho_2 * e_1)) + / 2000 * (/ 2 ^ 90 * (reach + 1)).
Proof.
  intros S_is a0 b0 E1 E2. unfold normal_loses. rewrite S_is. destruct h32_powers as [h0 hh]. set (r := rho_1 + rho_2) in *.
  assert (R1 : 1 <= reach <= 131072) by (unfold reach; simpl in *; lra).
  assert (ra := Rmult_le_compat_l rho_1 _ _ a0 E2). assert (rb := Rmult_le_compat_l rho_2 _ _ b0 E1).
  assert (Rr : 0 <= reach * r) by (unfold r; apply Rmult_le_pos; lra).
  assert (hR : h * reach <= / 2 ^ 126 * reach) by (apply Rmult_le_compat_r; lra).
  assert (hRr := Rmult_le_compat_r (reach * r) _ _ Rr (proj2 h0)).
  assert (R2 : h * (reach * (reach * r)) <= / 2 ^ 126 * (131072 * (reach * r))).
  { apply Rmult_le_compat; try lra; [apply Rmult_le_pos; lra | apply Rmult_le_compat_r; lra]. }
  unfold r in *. simpl in *. lra.
Qed.
End Plane.

(* ---- N . a: delta_determinant, where a lies anywhere ---- *)
Section Determinant.
Variable x : nat -> R.
Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation h := h32.
Definition determinant := quotient_1_under.
Definition delta := match quotient_4_under with Sub _ (Times _ d) => d | _ => Const 0 end.
(* N, det and delta_determinant, as they are computed: each is one float, wherever it is used. *)
Definition N_x := 90%nat.
Definition N_y := 91%nat.
Definition N_w := 92%nat.
Definition det := 93%nat.
Definition delta_det := 94%nat.
Definition determinant_of n_x n_y n_w := Fma n_x (Given a_x 0) (Fma n_y (Given a_y 0) (Mul n_w (Given a_z 0))).
Lemma determinant_is : determinant = determinant_of quotient_1_over quotient_2_over quotient_3_over.
Proof. reflexivity. Qed.
Let E := x error. Let F := x error_w.
Hypotheses (E_in : / 2 ^ 90 <= E) (F_in : / 2 ^ 90 <= F).
Let x1 := Rabs (x b_x - x a_x). Let y1 := Rabs (x b_y - x a_y). Let w1 := Rabs (x b_z - x a_z).
Let x2 := Rabs (x c_x - x a_x). Let y2 := Rabs (x c_y - x a_y). Let w2 := Rabs (x c_z - x a_z).
Let sides := x1 + y1 + w1 + (x2 + y2 + w2).
Let D := (x1 + y1 + w1) * (2 * E + 2 * F) + (x2 + y2 + w2) * (2 * E + 2 * F) + 2 * ((2 * E + 2 * F) * (2 * E + 2 * F)).
Let size_x := y1 * w2 + w1 * y2. Let size_y := x1 * w2 + w1 * x2. Let size_w := x1 * y2 + y1 * x2.
Let far_x := Rabs (x a_x) + E. Let far_y := Rabs (x a_y) + E. Let far_w := Rabs (x a_z) + F.
(* The kernel's delta_determinant for the N that it has computed. *)
Definition real_delta n_x n_y n_w :=
  Rabs n_x * E + Rabs n_y * E + Rabs n_w * F +
  / 4194304 * (Rabs (n_w * x a_z) + (Rabs (n_x * x a_x) + Rabs (n_y * x a_y))) +
  / 2 ^ 90 * (Rabs (x a_x) + Rabs (x a_y) + Rabs (x a_z) + 1) +
  ((far_x + far_y + far_w) * D + / 4194304 * (far_x * size_x + far_y * size_y + far_w * size_w)).
Ltac are_positive := unfold x1, y1, w1, x2, y2, w2; repeat split; apply Rabs_pos.
Lemma sides0 : 0 <= x1 /\ 0 <= y1 /\ 0 <= w1 /\ 0 <= x2 /\ 0 <= y2 /\ 0 <= w2.
Proof. are_positive. Qed.
(* What underflow takes of a coordinate of N. *)
Lemma taken_of_sides : h * (20 * sides + 8) <= / 2 ^ 30 * D + 8 * h.
Proof.
  destruct sides0 as (p1 & p2 & p3 & p4 & p5 & p6). destruct h32_powers as [h0 hh].
  assert (hF : h <= / 2 ^ 36 * F) by (simpl in *; lra). assert (s0 : 0 <= sides) by (unfold sides; lra).
  assert (G := Rmult_le_compat_r sides _ _ s0 hF).
  assert (sE : 0 <= sides * E) by (apply Rmult_le_pos; simpl in *; lra).
  assert (sF : 0 <= sides * F) by (apply Rmult_le_pos; simpl in *; lra).
  assert (e2 : 0 <= (2 * E + 2 * F) * (2 * E + 2 * F)) by (apply Rmult_le_pos; simpl in *; lra).
  replace D with (2 * (sides * E) + 2 * (sides * F) + 2 * ((2 * E + 2 * F) * (2 * E + 2 * F))) by (unfold D, sides; ring).
  simpl in *. lra.
Qed.

(* The real sides, and the real a. *)
Variables X1 Y1 W1 X2 Y2 W2 A_x A_y A_w : R.
Let near p q e := Rabs (p - q) <= e.
Hypotheses (x1_near : near X1 (x b_x - x a_x) (2 * E)) (x2_near : near X2 (x c_x - x a_x) (2 * E)).
Hypotheses (y1_near : near Y1 (x b_y - x a_y) (2 * E)) (y2_near : near Y2 (x c_y - x a_y) (2 * E)).
Hypotheses (w1_near : near W1 (x b_z - x a_z) (2 * F)) (w2_near : near W2 (x c_z - x a_z) (2 * F)).
Hypotheses (a_x_near : near A_x (x a_x) E) (a_y_near : near A_y (x a_y) E) (a_w_near : near A_w (x a_z) F).

Ltac moved N1 N2 N3 N4 C e :=
  assert (A := product_moves _ _ _ _ _ _ N1 N2); assert (B := product_moves _ _ _ _ _ _ N3 N4);
  destruct sides0 as (p1 & p2 & p3 & p4 & p5 & p6); destruct h32_powers as [h0 hh]; assert (T := taken_of_sides);
  assert (G := Rmult_le_compat_r _ _ _ (permanent_positive x e) four_roundings); apply near32 in C;
  assert (Le : lost32 x e <= h * (20 * sides + 8)) by (
    unfold lost32, sides; cbn -[u32 h32]; unfold of_product, alpha; rewrite ?u32_value; simpl pow;
    fold x1 y1 w1 x2 y2 w2; simpl in h0, hh;
    assert (q1 := Rmult_le_pos h x1 ltac:(lra) p1); assert (q2 := Rmult_le_pos h y1 ltac:(lra) p2);
    assert (q3 := Rmult_le_pos h w1 ltac:(lra) p3); assert (q4 := Rmult_le_pos h x2 ltac:(lra) p4);
    assert (q5 := Rmult_le_pos h y2 ltac:(lra) p5); assert (q6 := Rmult_le_pos h w2 ltac:(lra) p6); lra);
  change (roundings e) with 4%nat in C; assert (E0 := E_in); assert (F0 := F_in);
  assert (positive : forall p q, 0 <= p -> 0 <= q -> 0 <= p * q) by (intros; now apply Rmult_le_pos);
  assert (r1 : 0 <= E) by (simpl in *; lra); assert (r2 : 0 <= F) by (simpl in *; lra);
  assert (k1 := positive _ _ p1 r1); assert (k2 := positive _ _ p2 r1); assert (k3 := positive _ _ p3 r1);
  assert (k4 := positive _ _ p4 r1); assert (k5 := positive _ _ p5 r1); assert (k6 := positive _ _ p6 r1);
  assert (l1 := positive _ _ p1 r2); assert (l2 := positive _ _ p2 r2); assert (l3 := positive _ _ p3 r2);
  assert (l4 := positive _ _ p4 r2); assert (l5 := positive _ _ p5 r2); assert (l6 := positive _ _ p6 r2);
  assert (m1 := positive _ _ r1 r1); assert (m2 := positive _ _ r1 r2); assert (m3 := positive _ _ r2 r2);
  cbn [real permanent e] in C, G; fold x1 y1 w1 x2 y2 w2 in A, B, C, G; apply between in A, B, C.
Theorem n_x_moves v : computes32 x quotient_1_over v ->
  Rabs (Y1 * W2 - W1 * Y2 - v) <= (1 + / 2 ^ 29) * D + (1 + / 1048576) * / 4194304 * size_x + 8 * h.
Proof.
  intros C. moved y1_near w2_near w1_near y2_near C quotient_1_over. unfold D, size_x in *. apply Rabs_le. simpl in *. lra.
Qed.
Theorem n_y_moves v : computes32 x quotient_2_over v ->
  Rabs (W1 * X2 - X1 * W2 - v) <= (1 + / 2 ^ 29) * D + (1 + / 1048576) * / 4194304 * size_y + 8 * h.
Proof.
  intros C. moved w1_near x2_near x1_near w2_near C quotient_2_over. unfold D, size_y in *. apply Rabs_le. simpl in *. lra.
Qed.
Theorem n_w_moves v : computes32 x quotient_3_over v ->
  Rabs (X1 * Y2 - Y1 * X2 - v) <= (1 + / 2 ^ 29) * D + (1 + / 1048576) * / 4194304 * size_w + 8 * h.
Proof.
  intros C. moved x1_near y2_near y1_near x2_near C quotient_3_over. unfold D, size_w in *. apply Rabs_le. simpl in *. lra.
Qed.

(* An error times h is less than a share of the bound: of its rest, or where it is large of its third power. *)
Lemma few_of_error e : 0 <= e -> (e = E \/ e = F) -> h * e <= / 2 ^ 30 * (/ 2 ^ 90 + e * D).
Proof.
  intros e0 H. destruct h32_powers as [h0 hh]. destruct sides0 as (p1 & p2 & p3 & p4 & p5 & p6).
  assert (E0 := E_in). assert (F0 := F_in). assert (r1 : 0 <= E) by (simpl in *; lra). assert (r2 : 0 <= F) by (simpl in *; lra).
  assert (ee : 0 <= e * e) by (now apply Rmult_le_pos).
  assert (D0 : e * e <= D).
  { assert (s1 := Rmult_le_pos (x1 + y1 + w1) (2 * E + 2 * F) ltac:(lra) ltac:(lra)).
    assert (s2 := Rmult_le_pos (x2 + y2 + w2) (2 * E + 2 * F) ltac:(lra) ltac:(lra)).
    assert (s3 := Rmult_le_compat e (2 * E + 2 * F) e (2 * E + 2 * F) e0 e0 ltac:(destruct H; lra) ltac:(destruct H; lra)).
    unfold D. lra. }
  destruct (Rle_dec e 1) as [small | large].
  - assert (G := Rmult_le_compat h (/ 2 ^ 126) e 1 ltac:(lra) e0 ltac:(lra) small).
    assert (0 <= e * D) by (apply Rmult_le_pos; lra). simpl in *. lra.
  - assert (G := Rmult_le_compat h (/ 2 ^ 126) e (e * D) ltac:(lra) e0 ltac:(lra)).
    assert (K := Rmult_le_compat_l e 1 D e0). assert (K2 := Rmult_le_compat 1 e 1 e ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)).
    specialize (K ltac:(lra)). specialize (G ltac:(lra)). simpl in *. lra.
Qed.
Theorem determinant_moves v : computes32 x quotient_1_over (x N_x) -> computes32 x quotient_2_over (x N_y) ->
  computes32 x quotient_3_over (x N_w) -> computes32 x (determinant_of (Given N_x 0) (Given N_y 0) (Given N_w 0)) v ->
  Rabs ((Y1 * W2 - W1 * Y2) * A_x + (W1 * X2 - X1 * W2) * A_y + (X1 * Y2 - Y1 * X2) * A_w - v) <=
  (1 + / 2 ^ 10) * real_delta (x N_x) (x N_y) (x N_w).
Proof.
  intros Cx Cy Cw C. destruct (step32_fma _ _ _ _ _ C) as (n_x & a & r & Cn & Ca & C1 & R1). apply given32_is in Cn, Ca. subst a.
  destruct (step32_fma _ _ _ _ _ C1) as (n_y & a & r' & Cn' & Ca & C2 & R2). apply given32_is in Cn', Ca. subst a.
  destruct (step32_mul _ _ _ _ C2) as (n_w & a & Cn'' & Ca & R3). apply given32_is in Cn'', Ca. subst a.
  rewrite <- Cn in Cx. rewrite <- Cn' in Cy. rewrite <- Cn'' in Cw. rewrite <- Cn, <- Cn', <- Cn''. clear Cn Cn' Cn''.
  assert (N1 := n_x_moves _ Cx). assert (N2 := n_y_moves _ Cy). assert (N3 := n_w_moves _ Cw). clear C C1 C2 Cx Cy Cw.
  destruct h32_powers as [h0 hh]. assert (E0 := E_in). assert (F0 := F_in).
  assert (r1 : 0 <= E) by (simpl in *; lra). assert (r2 : 0 <= F) by (simpl in *; lra).
  assert (fE := few_of_error E r1 ltac:(now left)). assert (fF := few_of_error F r2 ltac:(now right)).
  destruct sides0 as (p1 & p2 & p3 & p4 & p5 & p6).
  assert (D0 : 0 <= D).
  { unfold D. repeat apply Rplus_le_le_0_compat; repeat apply Rmult_le_pos; lra. }
  assert (positive : forall p q, 0 <= p -> 0 <= q -> 0 <= p * q) by (intros; now apply Rmult_le_pos).
  assert (z1 : 0 <= size_x) by (unfold size_x; apply Rplus_le_le_0_compat; now apply positive).
  assert (z2 : 0 <= size_y) by (unfold size_y; apply Rplus_le_le_0_compat; now apply positive).
  assert (z3 : 0 <= size_w) by (unfold size_w; apply Rplus_le_le_0_compat; now apply positive).
  (* The roundings. *)
  assert (b1 := Rabs_pos n_x). assert (b2 := Rabs_pos n_y). assert (b3 := Rabs_pos n_w).
  assert (c1 := Rabs_pos (x a_x)). assert (c2 := Rabs_pos (x a_y)). assert (c3 := Rabs_pos (x a_z)).
  assert (d1 := Rabs_pos (n_x * x a_x)). assert (d2 := Rabs_pos (n_y * x a_y)). assert (d3 := Rabs_pos (n_w * x a_z)).
  assert (t1 := Rabs_triang (n_x * x a_x) r). assert (t2 := Rabs_triang (n_y * x a_y) r').
  assert (t3 := Rabs_triang (r' - n_w * x a_z) (n_w * x a_z)). replace (r' - n_w * x a_z + n_w * x a_z) with r' in t3 by ring.
  assert (t4 := Rabs_triang (r - (n_y * x a_y + r')) (n_y * x a_y + r')).
  replace (r - (n_y * x a_y + r') + (n_y * x a_y + r')) with r in t4 by ring.
  (* What N and a move. *)
  assert (far : forall A a e, Rabs (A - a) <= e -> Rabs A <= Rabs a + e).
  { intros A a e H. assert (T := Rabs_triang (A - a) a). replace (A - a + a) with A in T by ring. lra. }
  assert (M1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N1 (far _ _ _ a_x_near)).
  assert (M2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N2 (far _ _ _ a_y_near)).
  assert (M3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N3 (far _ _ _ a_w_near)).
  assert (K1 := Rmult_le_compat_l _ _ _ b1 a_x_near). assert (K2 := Rmult_le_compat_l _ _ _ b2 a_y_near).
  assert (K3 := Rmult_le_compat_l _ _ _ b3 a_w_near). rewrite <- !Rabs_mult in M1, M2, M3, K1, K2, K3.
  fold far_x in M1. fold far_y in M2. fold far_w in M3.
  assert (far0 : 0 <= far_x /\ 0 <= far_y /\ 0 <= far_w) by (unfold far_x, far_y, far_w; repeat split; lra).
  destruct far0 as (f1 & f2 & f3).
  assert (g1 := positive _ _ f1 D0). assert (g2 := positive _ _ f2 D0). assert (g3 := positive _ _ f3 D0).
  assert (i1 := positive _ _ f1 z1). assert (i2 := positive _ _ f2 z2). assert (i3 := positive _ _ f3 z3).
  (* What underflow takes. *)
  assert (hn : forall b e, 0 <= b -> / 2 ^ 90 <= e -> h * b <= / 2 ^ 36 * (b * e) /\ 0 <= b * e).
  { intros b e B0 e0. assert (G := Rmult_le_compat_r b h (/ 2 ^ 36 * e) B0 ltac:(simpl in *; lra)).
    split; [lra | apply positive; [exact B0 | simpl in *; lra]]. }
  destruct (hn _ _ b1 E_in). destruct (hn _ _ b2 E_in). destruct (hn _ _ b3 F_in).
  assert (ha : forall b, 0 <= b -> 0 <= h * b <= / 2 ^ 126 * b).
  { intros b B0. split; [apply positive; lra | apply Rmult_le_compat_r; lra]. }
  assert (ha4 := ha _ b1). assert (ha5 := ha _ b2). assert (ha6 := ha _ b3).
  assert (ha1 := ha _ c1). assert (ha2 := ha _ c2). assert (ha3 := ha _ c3).
  assert (eD : E * D <= far_x * D) by (apply Rmult_le_compat_r; unfold far_x; lra).
  assert (fD : F * D <= far_w * D) by (apply Rmult_le_compat_r; unfold far_w; lra).
  assert (hfx : h * far_x = h * Rabs (x a_x) + h * E) by (unfold far_x; ring).
  assert (hfy : h * far_y = h * Rabs (x a_y) + h * E) by (unfold far_y; ring).
  assert (hfw : h * far_w = h * Rabs (x a_z) + h * F) by (unfold far_w; ring).
  replace ((Y1 * W2 - W1 * Y2) * A_x + (W1 * X2 - X1 * W2) * A_y + (X1 * Y2 - Y1 * X2) * A_w - v) with
    ((Y1 * W2 - W1 * Y2 - n_x) * A_x + (W1 * X2 - X1 * W2 - n_y) * A_y + (X1 * Y2 - Y1 * X2 - n_w) * A_w +
     (n_x * (A_x - x a_x) + n_y * (A_y - x a_y) + n_w * (A_w - x a_z)) -
     ((v - (n_x * x a_x + r)) + (r - (n_y * x a_y + r')) + (r' - n_w * x a_z))) by ring.
  unfold real_delta. clearbody far_x far_y far_w size_x size_y size_w D E F.
  apply between in M1, M2, M3, K1, K2, K3. simpl in fE, fF, N1, M1, M2, M3. simpl.
  assert (S : Rabs (v - (n_x * x a_x + r)) + Rabs (r - (n_y * x a_y + r')) + Rabs (r' - n_w * x a_z) <=
    302 / 100 * u * (Rabs (n_x * x a_x) + Rabs (n_y * x a_y) + Rabs (n_w * x a_z)) +
    3 * h * (Rabs n_x + Rabs n_y + Rabs n_w + Rabs (x a_x) + Rabs (x a_y) + Rabs (x a_z) + 5)).
  { lra. }
  assert (v1 := between _ _ (Rle_refl (Rabs (v - (n_x * x a_x + r))))).
  assert (v2 := between _ _ (Rle_refl (Rabs (r - (n_y * x a_y + r'))))).
  assert (v3 := between _ _ (Rle_refl (Rabs (r' - n_w * x a_z)))). clear R1 R2 R3 t1 t2 t3 t4.
  apply Rabs_le. simpl in *. lra.
Qed.
End Determinant.

(* ---- The quotients of the margin, as they are computed ---- *)
Ltac few_roundings := try (lazymatch goal with |- (_ <= 32)%nat => vm_compute; lia end).
Section Quotient.
Variable x : nat -> R.
Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation h := h32.
Definition reach_sum := Add (Given point_error 0) (Given side 0).
Definition e_sum := let E := Given error 0 in let F := Mul reach_sum (Given error_w 0) in Add (Add (Add E F) E) F.
Definition rho_sum greatest w := Add (Given greatest 0) (Mul (Abs (Diff w a_z)) (Given point_error 0)).
Definition size_of b c b' c' a a' := Add (Abs (Mul (Diff b a) (Diff c a'))) (Abs (Mul (Diff b' a') (Diff c' a))).
Definition size_w := size_of b_x c_y b_y c_x a_x a_y.
Definition size_y := size_of b_x c_z b_z c_x a_x a_z.
Definition size_x := size_of b_y c_z b_z c_y a_y a_z.
Definition np_sum := Add (Add (Times underflow_term (Add reach_sum (Const 1)))
  (Times 2 (Add (Add (Mul e_sum (rho_sum greater_3 b_z)) (Mul e_sum (rho_sum greater_6 c_z))) (Mul e_sum e_sum))))
  (Times of_products (Add size_w (Add (Mul size_y reach_sum) (Mul size_x reach_sum)))).
Definition over_of d := Add np_sum (Mul largest d).
Definition under_of n d := Sub (Abs n) (Times inflation d).
Lemma quotients_are : quotient_4_over = over_of delta /\ quotient_4_under = under_of determinant delta /\
  quotient_5_over = Add (Abs quotient_1_over) (Abs quotient_2_over) /\ quotient_5_under = quotient_4_under.
Proof. repeat split. Qed.

Definition sides := ((b_x, a_x) :: (b_y, a_y) :: (b_z, a_z) :: (c_x, a_x) :: (c_y, a_y) :: (c_z, a_z) :: nil)%list.
Lemma size_in S s : (forall i j, List.In (i, j) sides -> Rabs (x i - x j) <= S) -> List.In s (size_x :: size_y :: size_w :: nil)%list ->
  loses x s (h * (24 * S + 20)) /\ permanent x s = real x s /\ 0 <= real x s /\ (roundings s <= 32)%nat.
Proof.
  intros short I. destruct h32_powers as [h0 _]. simpl in h0.
  assert (S0 : 0 <= S) by (eapply Rle_trans; [apply Rabs_pos | apply (short b_x a_x); cbn; tauto]).
  assert (hS := Rmult_le_pos h S ltac:(lra) S0). assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)).
  assert (one : forall i j k l, List.In (i, j) sides -> List.In (k, l) sides -> loses x (Abs (Mul (Diff i j) (Diff k l))) (h * (11 * S + 4))).
  { intros i j k l A B. eapply loses_abs; [apply (loses_mul x _ _ S S (5 * h) (5 * h)); few_roundings; try exact (short _ _ A); try exact (short _ _ B);
      try (apply loses_diff; apply Rle_refl); apply Rle_refl | lra]. }
  assert (P : only_positive x s) by (destruct I as [<- | [<- | [<- | []]]]; cbn; tauto).
  destruct (permanent_is x s P). repeat split; auto; [| destruct I as [<- | [<- | [<- | []]]]; cbn; lia].
  destruct I as [<- | [<- | [<- | []]]]; (eapply loses_add; [apply one; cbn; tauto | apply one; cbn; tauto | lra]).
Qed.

Let r := x point_error + x side. Let E := x error. Let F := x error_w.
Hypotheses (side_in : 1 <= x side <= 2 ^ 16) (point_error_in : 0 <= x point_error <= 2 ^ 16).
Hypotheses (E_in : / 2 ^ 90 <= E) (F_in : / 2 ^ 90 <= F).
Hypotheses (greater_3_in : 0 <= x greater_3) (greater_6_in : 0 <= x greater_6).
Let e := E + r * F + E + r * F.
Let rho_1 := x greater_3 + Rabs (x b_z - x a_z) * x point_error.
Let rho_2 := x greater_6 + Rabs (x c_z - x a_z) * x point_error.
Variable S : R.
Hypothesis S_in : S <= 4 * r * (rho_1 + rho_2).  (* edge_functions.v, rho_has *)
Hypothesis short : forall i j, List.In (i, j) sides -> Rabs (x i - x j) <= S.
Let few := / 85070591730234615865843651857942052864.  (* 2^-126 *)
Lemma h_in : 0 < h <= few /\ h <= / 68719476736 * E /\ h <= / 68719476736 * F.
Proof. destruct h32_powers as [[h0 h1] _]. unfold few. simpl in *. repeat split; lra. Qed.
Lemma r_in : 1 <= r <= 131072 /\ 0 <= x point_error <= r.
Proof. unfold r. simpl in *. lra. Qed.
Lemma e_in : 0 <= r * F /\ F <= r * F /\ h * r <= / 68719476736 * e /\ h <= / 68719476736 * e /\ F <= e /\
  h * F <= / 68719476736 * e.
Proof.
  destruct h_in as (h0 & hE & hF). destruct r_in as (r0 & _). unfold few in h0.
  assert (G := Rmult_le_compat_r r _ _ ltac:(lra) hF). assert (G2 := Rmult_le_compat_r F 1 r ltac:(lra) ltac:(lra)).
  assert (G3 := Rmult_le_compat_r F h 1 ltac:(lra) ltac:(lra)).
  assert (G4 := Rmult_le_compat_r F _ _ ltac:(lra) (proj2 h0)).
  unfold e. repeat split; lra.
Qed.
Lemma loses_e : loses x e_sum (/ 1073741824 * e) /\ permanent x e_sum = e /\ roundings e_sum = 5%nat.
Proof.
  destruct h_in as (h0 & hE & hF). destruct r_in as (r0 & p0). destruct e_in as (e0 & e1 & e2 & e3 & e4 & e5). unfold few in h0.
  split; [| split; [| reflexivity]].
  - assert (LR : loses x reach_sum (5 * h)).
    { apply (loses_add x _ _ h h); try (apply loses_given); lra. }
    assert (LF : loses x (Mul reach_sum (Given error_w 0)) (h * (2 * r + 6 * F + 3))).
    { apply (loses_mul x _ _ r F (5 * h) h); try exact LR; try (apply loses_given; lra); few_roundings;
        [cbn; unfold r; rewrite !Rabs_pos_eq; lra | cbn; unfold F; rewrite Rabs_pos_eq; unfold F in *; lra |].
      assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)). assert (hr := Rmult_le_compat_l h _ _ ltac:(lra) (proj1 r0)).
      assert (hF0 := Rmult_le_pos h F ltac:(lra) ltac:(lra)). lra. }
    assert (hF0 := Rmult_le_pos h F ltac:(lra) ltac:(lra)).
    eapply loses_add; [| exact LF |]; [eapply loses_add; [| apply loses_given |]; [eapply loses_add; [| exact LF |] | |] |];
      try apply loses_given; try apply Rle_refl. lra.
  - unfold e, e_sum, r, E, F in *. cbn. rewrite !Rabs_pos_eq; lra.
Qed.
Lemma loses_rho g w : 0 <= x g -> List.In (w, a_z) sides ->
  loses x (rho_sum g w) (h * (2 * S + 8 * r + 10)).
Proof.
  intros G W. apply short in W. destruct h_in as (h0 & hE & hF). destruct r_in as (r0 & p0). unfold few in h0, hE, hF.
  assert (S0 : 0 <= S) by (eapply Rle_trans; [apply Rabs_pos | exact W]).
  assert (hp := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 p0)). assert (hS := Rmult_le_pos h S ltac:(lra) S0).
  assert (hp0 := Rmult_le_pos h _ ltac:(lra) (proj1 p0)). assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)).
  eapply loses_add; [apply loses_given; apply Rle_refl | |].
  - apply (loses_mul x _ _ S (x point_error) (6 * h) h); few_roundings; [exact W | cbn; rewrite Rabs_pos_eq; lra | | apply loses_given; lra | apply Rle_refl].
    eapply loses_abs; [apply loses_diff; apply Rle_refl | lra].
  - lra.
Qed.
Lemma np_is : real x np_sum = / 1237940039285380274899124224 * (r + 1) + 2 * (e * rho_1 + e * rho_2 + e * e) +
  / 4194304 * (real x size_w + (real x size_y * r + real x size_x * r)).
Proof.
  unfold np_sum. cbn [real]. change (real x e_sum) with e. change (real x reach_sum) with r. change (real x (rho_sum greater_3 b_z)) with rho_1.
  change (real x (rho_sum greater_6 c_z)) with rho_2. rewrite Q2R_1, Q2R_2.
  replace (Q2R of_products) with (/ 4194304) by (unfold Q2R; simpl; lra).
  replace (Q2R underflow_term) with (/ 1237940039285380274899124224) by (unfold Q2R; simpl; lra). reflexivity.
Qed.
Lemma loses_np : loses x np_sum (/ 4000 * real x np_sum).
Proof.
  rewrite np_is. destruct h_in as (h0 & hE & hF). destruct r_in as (r0 & p0). destruct e_in as (e0 & e1 & e2 & e3 & e4 & e5).
  assert (S0 : 0 <= S) by (eapply Rle_trans; [apply Rabs_pos | apply (short b_x a_x); cbn; tauto]). unfold few in h0.
  destruct loses_e as (Le & Pe & Re). assert (L1 := loses_rho greater_3 b_z greater_3_in ltac:(cbn; tauto)).
  assert (L2 := loses_rho greater_6 c_z greater_6_in ltac:(cbn; tauto)).
  destruct (size_in S size_x short ltac:(cbn; tauto)) as (Lx & Px & x0 & Rx). destruct (size_in S size_y short ltac:(cbn; tauto)) as (Ly & Py & y0 & Ry).
  destruct (size_in S size_w short ltac:(cbn; tauto)) as (Lw & Pw & w0 & Rw).
  assert (rho1 : permanent x (rho_sum greater_3 b_z) = rho_1 /\ 0 <= rho_1) by (apply permanent_is; cbn; tauto).
  assert (rho2 : permanent x (rho_sum greater_6 c_z) = rho_2 /\ 0 <= rho_2) by (apply permanent_is; cbn; tauto).
  destruct rho1 as [P1 q1]. destruct rho2 as [P2 q2]. set (q := rho_1 + rho_2) in *.
  assert (LR : loses x reach_sum (5 * h)).
  { apply (loses_add x _ _ h h); try (apply loses_given); lra. }
  assert (PR : permanent x reach_sum = r) by (cbn; unfold r; rewrite !Rabs_pos_eq; lra).
  assert (e_0 : 0 <= e) by lra. assert (eq := Rmult_le_pos e q e_0 ltac:(unfold q; lra)). assert (ee := Rmult_le_pos e e e_0 e_0).
  set (l := h * (2 * S + 8 * r + 10)) in *.
  assert (hrq : h * (4 * r * q) <= / 1000000000000000 * q).
  { assert (G := Rmult_le_compat_r q (h * (4 * r)) (/ 1000000000000000) ltac:(unfold q; lra)).
    assert (G2 := Rmult_le_compat h (/ 85070591730234615865843651857942052864) r 131072 ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)).
    specialize (G ltac:(lra)). lra. }
  assert (q_0 : 0 <= q) by (unfold q; lra).
  assert (hS := Rmult_le_compat_l h _ _ ltac:(lra) S_in). fold q in hS.
  assert (l_in : 0 <= l <= / 100000000000000 * q + / 1000000000 * e).
  { unfold l. split; [apply Rmult_le_pos; lra |]. lra. }
  assert (el := Rmult_le_compat_l e _ _ e_0 (proj2 l_in)). assert (el0 := Rmult_le_pos _ _ e_0 (proj1 l_in)).
  assert (of_rho : forall g w rho, permanent x (rho_sum g w) = rho -> 0 <= rho <= q -> loses x (rho_sum g w) l ->
    loses x (Mul e_sum (rho_sum g w)) (/ 100000000 * (e * q + e * e) + 3 * h)).
  { intros g w rho P q0 L. apply (loses_mul x _ _ e rho (/ 1073741824 * e) l); auto; try (rewrite Re; lia); few_roundings; try lra.
    assert (er := Rmult_le_compat_l e _ _ e_0 (proj2 q0)). lra. }
  assert (M1 := of_rho _ _ _ P1 ltac:(unfold q; lra) L1). assert (M2 := of_rho _ _ _ P2 ltac:(unfold q; lra) L2).
  assert (M3 : loses x (Mul e_sum e_sum) (/ 100000000 * (e * e) + 3 * h)).
  { apply (loses_mul x _ _ e e (/ 1073741824 * e) (/ 1073741824 * e)); auto; try (rewrite Re; lia); try lra. }
  set (s_x := real x size_x) in *. set (s_y := real x size_y) in *. set (s_w := real x size_w) in *.
  set (k := h * (24 * S + 20)) in *.
  assert (k_in : 0 <= k <= 24 * (h * (4 * r * q)) + 20 * h).
  { unfold k. split; [apply Rmult_le_pos; lra |]. lra. }
  assert (hrr : h * (4 * r * q) * r <= / 100000 * (e * q)).
  { assert (G := Rmult_le_compat_r (4 * (r * q)) _ _ ltac:(apply Rmult_le_pos; [lra | apply Rmult_le_pos; unfold q; lra]) e2).
    assert (G2 := Rmult_le_compat_l (e * q) _ _ eq (proj2 r0)). lra. }
  assert (kr : 0 <= k * r <= 24 / 100000 * (e * q) + 20 * (h * r)).
  { split; [apply Rmult_le_pos; lra |]. assert (G := Rmult_le_compat_r r _ _ ltac:(lra) (proj2 k_in)). lra. }
  assert (kq : k <= k * r) by (assert (G := Rmult_le_compat_l k _ _ ltac:(lra) (proj1 r0)); lra).
  assert (hr0 := Rmult_le_pos h r ltac:(lra) ltac:(lra)).
  assert (hr1 : h * r <= / 85070591730234615865843651857942052864 * r) by (apply Rmult_le_compat_r; lra).
  assert (of_size : forall s v, permanent x s = v -> 0 <= v -> (roundings s <= 32)%nat -> loses x s k ->
    loses x (Mul s reach_sum) (/ 1000000 * (v * r) + 2 * (k * r) + 3 * h)).
  { intros s v P v0 K L. apply (loses_mul x _ _ v r k (5 * h)); auto; few_roundings; try lra.
    assert (vr := Rmult_le_compat_l v _ _ v0 (proj1 r0)). assert (vh := Rmult_le_compat_l v _ _ v0 (proj2 h0)).
    assert (kh := Rmult_le_compat_l k _ _ (proj1 k_in) (proj2 h0)). lra. }
  assert (N1 := of_size _ _ Py y0 Ry Ly). assert (N2 := of_size _ _ Px x0 Rx Lx).
  assert (yr := Rmult_le_pos _ r y0 ltac:(lra)). assert (xr := Rmult_le_pos _ r x0 ltac:(lra)).
  assert (two : Rabs (Q2R 2) = 2) by (rewrite Q2R_2, Rabs_pos_eq; lra).
  assert (cp : Rabs (Q2R of_products) = / 4194304) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  assert (cu : Rabs (Q2R underflow_term) = / 1237940039285380274899124224) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  assert (eq_is : e * q = e * rho_1 + e * rho_2) by (unfold q; ring).
  eapply loses_add; [eapply loses_add; [| | apply Rle_refl] | |].
  - eapply loses_times; [eapply loses_add; [exact LR | apply loses_const; apply Rle_refl | apply Rle_refl] | apply Rle_refl].
  - eapply loses_times; [eapply loses_add; [eapply loses_add; [exact M1 | exact M2 | apply Rle_refl] | exact M3 | apply Rle_refl] | apply Rle_refl].
  - eapply loses_times; [eapply loses_add; [exact Lw | eapply loses_add; [exact N1 | exact N2 | apply Rle_refl] | apply Rle_refl] | apply Rle_refl].
  - rewrite two, cp, cu. lra.
Qed.

Let d := x delta_det. Let D := Rabs (x det). Let L := real x largest. Let T := real x np_sum. Let N := Rabs (x N_x) + Rabs (x N_y).
Hypothesis delta_in : / 2 ^ 91 <= d.
Lemma T_in : h <= / 68719476736 * T /\ h * r <= / 68719476736 * T /\ 0 <= T /\ 0 <= L /\ h * L <= / 34359738368 * (L * d).
Proof.
  destruct h_in as (h0 & hE & hF). destruct r_in as (r0 & p0). destruct e_in as (e0 & e1 & e2 & e3 & e4 & e5).
  assert (rho1 : permanent x (rho_sum greater_3 b_z) = rho_1 /\ 0 <= rho_1) by (apply permanent_is; cbn; tauto).
  assert (rho2 : permanent x (rho_sum greater_6 c_z) = rho_2 /\ 0 <= rho_2) by (apply permanent_is; cbn; tauto).
  destruct (size_in S size_x short ltac:(cbn; tauto)) as (_ & _ & x0 & _). destruct (size_in S size_y short ltac:(cbn; tauto)) as (_ & _ & y0 & _).
  destruct (size_in S size_w short ltac:(cbn; tauto)) as (_ & _ & w0 & _). destruct rho1 as [_ q1]. destruct rho2 as [_ q2].
  assert (T_is := np_is). fold T in T_is. assert (k0 : 0 <= e) by lra. assert (k1 := Rmult_le_pos _ _ k0 q1). assert (k2 := Rmult_le_pos _ _ k0 q2).
  assert (k3 := Rmult_le_pos _ _ k0 k0). assert (k4 := Rmult_le_pos _ r y0 ltac:(lra)). assert (k5 := Rmult_le_pos _ r x0 ltac:(lra)).
  assert (hr : h * r <= few * r) by (apply Rmult_le_compat_r; lra). unfold few in h0, hr. simpl in delta_in.
  assert (L0 : 0 <= L) by (apply permanent_is; cbn; repeat split; lra).
  assert (Ld := Rmult_le_compat_r L h (/ 34359738368 * d) L0 ltac:(lra)).
  repeat split; lra.
Qed.
Theorem over_least v : computes32 x (over_of (Given delta_det 0)) v -> (1 - / 3000) * (T + L * d) - / 2 ^ 100 * d <= v.
Proof.
  intros C. destruct h_in as (h0 & hE & hF). destruct r_in as (r0 & p0). destruct T_in as (T1 & T2 & T0 & L0 & hL). unfold few in h0.
  assert (PL : permanent x largest = L /\ 0 <= L) by (apply permanent_is; cbn; repeat split; lra). destruct PL as [PL _].
  assert (d0 : 0 <= d) by (simpl in delta_in; lra).
  assert (LR : loses x reach_sum (5 * h)).
  { apply (loses_add x _ _ h h); try (apply loses_given); lra. }
  assert (PR : permanent x reach_sum = r) by (cbn; unfold r; rewrite !Rabs_pos_eq; lra).
  assert (hr0 := Rmult_le_pos h r ltac:(lra) ltac:(lra)). assert (hL0 := Rmult_le_pos h L ltac:(lra) L0).
  assert (Q : Rabs (x quotient_1) + Rabs (x quotient_2) <= L).
  { unfold L. cbv [largest margin real]. assert (b1 := Rabs_pos (x quotient_1)). assert (b2 := Rabs_pos (x quotient_2)).
    assert (b3 := Rabs_pos (x quotient_3)). fold r.
    assert (c1 := Rmult_le_compat_l _ _ _ b1 (proj1 r0)). assert (c2 := Rmult_le_compat_l _ _ _ b2 (proj1 r0)). lra. }
  assert (hQ := Rmult_le_compat_l h _ _ ltac:(lra) Q).
  assert (of_slope : forall q, loses x (Mul (Abs (Given q 5)) reach_sum) (h * (6 * Rabs (x q) + 3 * r + 3))).
  { intros q. eapply (loses_mul x _ _ (Rabs (x q)) r (2 * h) (5 * h)); few_roundings; try (cbn; lra); try lra; auto.
    - eapply loses_abs; [apply loses_given; apply Rle_refl | lra].
    - assert (q0 := Rmult_le_pos h _ ltac:(lra) (Rabs_pos (x q))). assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)). lra. }
  assert (LL : loses x largest (h * (7 * L + 7 * r + 20))).
  { eapply loses_add; [eapply loses_abs; [apply loses_given; apply Rle_refl | apply Rle_refl] | eapply loses_add; [apply of_slope |
      apply of_slope | apply Rle_refl] |]. lra. }
  assert (LM : loses x (Mul largest (Given delta_det 0)) (/ 1000000000 * (L * d) + / 2 ^ 101 * d + / 1000000000 * T)).
  { apply (loses_mul x _ _ L d (h * (7 * L + 7 * r + 20)) h); auto; few_roundings; try lra.
    - cbn. unfold d. rewrite Rabs_pos_eq; unfold d in d0; lra.
    - apply loses_given. lra.
    - assert (dr := Rmult_le_compat_r (7 * r * d + 20 * d) h _ ltac:(repeat apply Rplus_le_le_0_compat; repeat apply Rmult_le_pos; lra) (proj2 h0)).
      assert (rd := Rmult_le_compat_r d _ _ d0 (proj2 r0)). assert (Ld := Rmult_le_pos L d L0 d0).
      assert (hLd := Rmult_le_compat_r (L * d) _ _ Ld (proj2 h0)). assert (hhL := Rmult_le_compat_l (h * L) _ _ hL0 (proj2 h0)).
      assert (hhr := Rmult_le_compat_l (h * r) _ _ hr0 (proj2 h0)). assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)).
      simpl. lra. }
  assert (LO : loses x (over_of (Given delta_det 0)) (/ 3500 * T + / 1000000 * (L * d) + / 2 ^ 100 * d)).
  { eapply loses_add; [exact loses_np | exact LM |]. fold T. assert (Ld := Rmult_le_pos L d L0 d0). simpl. lra. }
  assert (P : only_positive x (over_of (Given delta_det 0))).
  { cbn -[Q2R]. rewrite ?Q2R_1, ?Q2R_2. repeat split; try exact I; try (unfold Q2R; simpl; lra); unfold E, F, d in *; simpl in E_in, F_in; lra. }
  assert (M := least_positive x _ _ v P ltac:(vm_compute; lia) LO C). change (real x (over_of (Given delta_det 0))) with (T + L * d) in M.
  assert (Ld := Rmult_le_pos L d L0 d0). lra.
Qed.
Theorem under_most w : computes32 x (under_of (Given det 0) (Given delta_det 0)) w -> 0 < w ->
  w <= (1 + 2 * u) * (D - (1 + / 200) * d).
Proof.
  intros C w0. destruct h_in as (h0 & hE & hF). unfold few in h0. simpl in delta_in.
  destruct (step32_sub _ _ _ _ C) as (p & t & Cp & Ct & R).
  assert (p_is : p <= D + h).
  { inversion Cp as [ | | | | | ? q s Cq S' | | | | ]; subst. apply given32_is in Cq. subst q. apply seen32_near in S'.
    assert (G := Rabs_triang (s - x det) (x det)). replace (s - x det + x det) with s in G by ring. fold D in G. lra. }
  assert (i : 10099 / 10000 <= Q2R inflation <= 2).
  { replace (10099 / 10000) with (Q2R (10099 # 10000)) by (unfold Q2R; simpl; lra). rewrite <- Q2R_2.
    split; apply Qle_Rle, Qle_bool_iff; vm_compute; reflexivity. }
  assert (M := least_times x inflation _ d t Ct ltac:(lra) ltac:(lra) ltac:(intros q K; apply given32_is in K; fold d in K; lra)).
  assert (id := Rmult_le_compat_r d _ _ ltac:(lra) (proj1 i)). assert (ih := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 i)).
  destruct (Rle_dec 0 (p - t)) as [pos | neg].
  - rewrite (Rabs_pos_eq (p - t)) in R by exact pos. apply between in R. lra.
  - rewrite (Rabs_left (p - t)) in R by lra. apply between in R. lra.
Qed.
(* So both quotients are at least what quotient_moves asks for: d_p is the error of N . p with what the point's own adds, d_D that of
   det, l is at least the height. *)
Definition of_quotient : Q := 1 + (85 # 10000).
Theorem quotients_are_enough v w v_5 d_p d_D l : computes32 x (over_of (Given delta_det 0)) v ->
  computes32 x (under_of (Given det 0) (Given delta_det 0)) w -> computes32 x (Add (Abs (Given N_x 0)) (Abs (Given N_y 0))) v_5 ->
  0 < w -> D <= 5 * w -> 0 <= d_p <= (1 + / 1000) * T + N * x point_error -> 0 <= d_D <= (1 + / 300) * d -> 0 <= l <= L + / 2 ^ 100 ->
  d_D < D /\ (d_p + l * d_D) / (D - d_D) <= Q2R of_quotient * (v / w + v_5 / w * x point_error) + / 2 ^ 95.
Proof.
  intros Cv Cw C5 w0 usable p_in D_in l_in. assert (V := over_least _ Cv). assert (W := under_most _ Cw w0).
  destruct h_in as (h0 & hE & hF). destruct r_in as (r0 & p0). destruct T_in as (T1 & T2 & T0 & L0 & hL). unfold few in h0. simpl in delta_in.
  assert (V5 := least_positive x (Add (Abs (Given N_x 0)) (Abs (Given N_y 0))) (7 * h) v_5 ltac:(cbn; tauto) ltac:(vm_compute; lia)
    ltac:(apply (loses_add x _ _ (2 * h) (2 * h)); [apply (loses_abs x _ h); [apply loses_given; lra | lra] |
      apply (loses_abs x _ h); [apply loses_given; lra | lra] | lra]) C5). cbn [real] in V5. fold N in V5.
  replace (Q2R of_quotient) with (10085 / 10000) by (unfold Q2R, of_quotient; simpl; lra).
  set (pe := x point_error) in *. assert (V5p := Rmult_le_compat_r pe _ _ (proj1 p0) V5).
  assert (hp := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 p0)).
  assert (N0 : 0 <= N) by (unfold N; apply Rplus_le_le_0_compat; apply Rabs_pos). assert (Np := Rmult_le_pos _ _ N0 (proj1 p0)).
  assert (Ld := Rmult_le_pos L d L0 ltac:(lra)). set (G := D - d_D).
  assert (G0 : 0 < G) by (unfold G; lra). split; [unfold G in G0; lra |].
  assert (Iw := Rinv_0_lt_compat _ w0). assert (IG := Rinv_0_lt_compat _ G0).
  assert (Gw : / G <= (1 + 2 * u) * / w).
  { apply Rmult_le_reg_r with G; [exact G0 |]. rewrite Rinv_l by lra.
    assert (W2 : w <= (1 + 2 * u) * G) by (unfold G; lra).
    assert (K := Rmult_le_compat_r (/ w) _ _ ltac:(lra) W2). rewrite Rinv_r in K by lra. lra. }
  assert (ld : l * d_D <= (1 + / 300) * (L * d) + / 2 ^ 99 * d).
  { assert (K := Rmult_le_compat _ _ _ _ (proj1 l_in) (proj1 D_in) (proj2 l_in) (proj2 D_in)). simpl in *. lra. }
  assert (ld0 := Rmult_le_pos _ _ (proj1 l_in) (proj1 D_in)).
  assert (T_is : d_p + l * d_D <= 10084 / 10000 * (v + v_5 * pe) + / 2 ^ 98 * d) by (simpl in *; lra).
  unfold Rdiv. eapply Rle_trans; [apply Rmult_le_compat; [lra | lra | exact T_is | exact Gw] |].
  assert (dw : d * / w <= 5).
  { apply Rmult_le_reg_r with w; [exact w0 |]. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  assert (vw : - (/ 2 ^ 98 * (d * / w)) <= 10084 / 10000 * ((v + v_5 * pe) * / w)).
  { assert (K := Rmult_le_compat_r (/ w) 0 _ ltac:(lra) (Rle_trans _ _ _ (Rplus_le_le_0_compat _ _ (proj1 p_in) ld0) T_is)). lra. }
  assert (dw0 := Rmult_le_pos d (/ w) ltac:(lra) ltac:(lra)). simpl in *. lra.
Qed.
(* d_p and d_D, by products_near, cross_moves and delta_np_has_it, and by determinant_moves. *)
Theorem np_has_it : 2 * (rho_1 * e + rho_2 * e + e * e) + ((1 + / 1048576) * Q2R of_products * real x sizes +
  (2 * r + 1) * normal_loses S) <= (1 + / 1000) * T.
Proof.
  destruct h_in as (h0 & hE & hF). destruct r_in as (r0 & p0). destruct e_in as (e0 & e1 & e2 & e3 & e4 & e5). unfold few in h0.
  assert (q1 : 0 <= rho_1) by (apply (permanent_is x (rho_sum greater_3 b_z)); cbn; tauto).
  assert (q2 : 0 <= rho_2) by (apply (permanent_is x (rho_sum greater_6 c_z)); cbn; tauto).
  assert (Ee : / 2 ^ 90 * r <= e).
  { assert (G := Rmult_le_compat_l r _ _ ltac:(lra) F_in). unfold e. lra. }
  assert (G := delta_np_has_it x side_in point_error_in (4 * r * (rho_1 + rho_2)) rho_1 rho_2 e e eq_refl q1 q2 Ee Ee). fold r in G.
  assert (M : (2 * r + 1) * normal_loses S <= (2 * r + 1) * normal_loses (4 * r * (rho_1 + rho_2))).
  { apply Rmult_le_compat_l; [lra |]. unfold normal_loses. apply Rmult_le_compat_l; lra. }
  destruct (size_in S size_x short ltac:(cbn; tauto)) as (_ & _ & x0 & _).
  destruct (size_in S size_y short ltac:(cbn; tauto)) as (_ & _ & y0 & _).
  destruct (size_in S size_w short ltac:(cbn; tauto)) as (_ & _ & w0 & _).
  assert (k4 := Rmult_le_pos _ r y0 ltac:(lra)). assert (k5 := Rmult_le_pos _ r x0 ltac:(lra)).
  assert (k1 := Rmult_le_pos _ e q1 ltac:(lra)).
  assert (k2 := Rmult_le_pos _ e q2 ltac:(lra)). assert (k3 := Rmult_le_pos e e ltac:(lra) ltac:(lra)).
  assert (T_is := np_is). fold T in T_is.
  change (real x sizes) with (real x size_w + (real x size_y * r + real x size_x * r)).
  replace (Q2R of_products) with (/ 4194304) by (unfold Q2R; simpl; lra).
  replace (/ 2 ^ 90) with (/ 1237940039285380274899124224) in G by (simpl; lra). lra.
Qed.
Lemma det_has_it A : 0 <= A -> (1 - / 2000) * A <= d -> (1 + / 2 ^ 9) * A <= (1 + / 300) * d.
Proof. simpl. lra. Qed.
End Quotient.

(* ---- delta_determinant, as it is computed ---- *)
Section Delta.
Variable x : nat -> R.
Open Scope R_scope.
Local Notation h := h32.
Definition product_with n a := Abs (Mul n (Given a 0)).
Definition of_n n_x n_y n_w := Add (Add (Add (Add (Mul (Abs n_x) (Given error 0)) (Mul (Abs n_y) (Given error 0)))
  (Mul (Abs n_w) (Given error_w 0)))
  (Times (1 # 4194304) (Add (product_with n_w a_z) (Add (product_with n_x a_x) (product_with n_y a_y)))))
  (Times underflow_term (Add (Add (Abs (Given a_z 0)) (Add (Abs (Given a_x 0)) (Abs (Given a_y 0)))) (Const 1))).
Definition far_of a e := Add (Abs (Given a 0)) (Given e 0).
Definition far_x := far_of a_x error.
Definition far_y := far_of a_y error.
Definition far_w := far_of a_z error_w.
Definition errors_sum := Add (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0).
Definition side_of v_z v_x v_y := Add (Abs (Diff v_z a_z)) (Add (Abs (Diff v_x a_x)) (Abs (Diff v_y a_y))).
Definition delta_n := Add (Add (Mul (side_of b_z b_x b_y) errors_sum) (Mul (side_of c_z c_x c_y) errors_sum))
  (Times 2 (Mul errors_sum errors_sum)).
Definition anywhere := Add (Mul (Add far_w (Add far_x far_y)) delta_n)
  (Times (1 # 4194304) (Add (Add (Mul far_x size_x) (Mul far_y size_y)) (Mul far_w size_w))).
Definition delta_of more := Add (of_n (Given N_x 0) (Given N_y 0) (Given N_w 0)) more.
Lemma delta_parts : delta = Add (of_n quotient_1_over quotient_2_over quotient_3_over) anywhere.
Proof. reflexivity. Qed.

Let E := x error. Let F := x error_w.
Hypotheses (E_in : / 2 ^ 90 <= E) (F_in : / 2 ^ 90 <= F).
Let R1 := real x (of_n (Given N_x 0) (Given N_y 0) (Given N_w 0)).
Let far := Rabs (x a_z) + (Rabs (x a_x) + Rabs (x a_y)).
Let n := Rabs (x N_x) * E + Rabs (x N_y) * E + Rabs (x N_w) * F.
Lemma errors_in : 0 < h <= / 85070591730234615865843651857942052864 /\ h <= / 68719476736 * E /\ h <= / 68719476736 * F /\
  / 1237940039285380274899124224 <= E /\ / 1237940039285380274899124224 <= F.
Proof. destruct h32_powers as [[h0 h1] _]. unfold E, F in *. simpl in *. repeat split; lra. Qed.
Lemma R1_is : R1 = n + / 4194304 * (Rabs (x N_w * x a_z) + (Rabs (x N_x * x a_x) + Rabs (x N_y * x a_y))) +
  / 1237940039285380274899124224 * (far + 1) /\ 0 <= n /\ 0 <= far.
Proof.
  destruct errors_in as (h0 & hE & hF & E0 & F0). split.
  - unfold R1, of_n, n, far, E, F. cbn [real]. rewrite Q2R_1. replace (Q2R (1 # 4194304)) with (/ 4194304) by (unfold Q2R; simpl; lra).
    replace (Q2R underflow_term) with (/ 1237940039285380274899124224) by (unfold Q2R; simpl; lra). reflexivity.
  - unfold n, far. assert (b1 := Rabs_pos (x N_x)). assert (b2 := Rabs_pos (x N_y)). assert (b3 := Rabs_pos (x N_w)).
    assert (c1 := Rabs_pos (x a_x)). assert (c2 := Rabs_pos (x a_y)). assert (c3 := Rabs_pos (x a_z)).
    split; [| lra]. repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; lra.
Qed.
Lemma loses_of_n : loses x (of_n (Given N_x 0) (Given N_y 0) (Given N_w 0)) (/ 10000 * R1 + 20 * (h * (E + F))).
Proof.
  destruct errors_in as (h0 & hE & hF & E0 & F0). destruct R1_is as (R_is & n0 & f0). rewrite R_is.
  assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)).
  assert (hE0 := Rmult_le_pos h E ltac:(lra) ltac:(lra)). assert (hF0 := Rmult_le_pos h F ltac:(lra) ltac:(lra)).
  assert (one : forall i e, / 1237940039285380274899124224 <= x e -> h <= / 68719476736 * x e ->
    loses x (Mul (Abs (Given i 0)) (Given e 0)) (/ 34359738368 * (Rabs (x i) * x e) + 3 * (h * x e) + 3 * h)).
  { intros i e e0 he. apply (loses_mul x _ _ (Rabs (x i)) (x e) (2 * h) h); few_roundings; try (cbn; lra).
    - cbn. rewrite Rabs_pos_eq; lra.
    - eapply loses_abs; [apply loses_given; apply Rle_refl | lra].
    - apply loses_given; lra.
    - assert (G := Rmult_le_compat_l _ _ _ (Rabs_pos (x i)) he). assert (G2 := Rmult_le_pos _ (x e) (Rabs_pos (x i)) ltac:(lra)).
      assert (G3 := Rmult_le_pos h (x e) ltac:(lra) ltac:(lra)). lra. }
  assert (product : forall i a e, h <= / 68719476736 * x e -> loses x (product_with (Given i 0) a)
    (/ 34359738368 * (Rabs (x i) * x e) + 2 * (h * Rabs (x a)) + 5 * h)).
  { intros i a e he. eapply loses_abs; [apply (loses_mul x _ _ (Rabs (x i)) (Rabs (x a)) h h); few_roundings; try (cbn; lra);
      try (apply loses_given; lra); apply Rle_refl |].
    assert (G := Rmult_le_compat_l _ _ _ (Rabs_pos (x i)) he). assert (G2 := Rmult_le_pos h _ ltac:(lra) (Rabs_pos (x a))).
    assert (G3 := Rmult_le_pos h _ ltac:(lra) (Rabs_pos (x i))). lra. }
  assert (few : forall a, loses x (Abs (Given a 0)) (2 * h)) by (intros; eapply loses_abs; [apply loses_given; apply Rle_refl | lra]).
  assert (c4 : Rabs (Q2R (1 # 4194304)) = / 4194304) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  assert (cu : Rabs (Q2R underflow_term) = / 1237940039285380274899124224) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  assert (hfar : h * far <= / 85070591730234615865843651857942052864 * far) by (apply Rmult_le_compat_r; lra).
  assert (p1 := Rabs_pos (x N_w * x a_z)). assert (p2 := Rabs_pos (x N_x * x a_x)). assert (p3 := Rabs_pos (x N_y * x a_y)).
  assert (hfar_is : h * far = h * Rabs (x a_z) + h * Rabs (x a_x) + h * Rabs (x a_y)) by (unfold far; ring).
  assert (n_is : n = Rabs (x N_x) * E + Rabs (x N_y) * E + Rabs (x N_w) * F) by reflexivity.
  assert (N1 := one N_x error E0 hE). assert (N2 := one N_y error E0 hE). assert (N3 := one N_w error_w F0 hF).
  assert (Q1 := product N_x a_x error hE). assert (Q2 := product N_y a_y error hE). assert (Q3 := product N_w a_z error_w hF).
  fold E F in N1, N2, N3, Q1, Q2, Q3.
  eapply loses_add; [eapply loses_add; [eapply loses_add; [eapply loses_add; [exact N1 | exact N2 | apply Rle_refl] | exact N3 |
    apply Rle_refl] | eapply loses_times; [eapply loses_add; [exact Q3 | eapply loses_add; [exact Q1 | exact Q2 | apply Rle_refl] |
    apply Rle_refl] | apply Rle_refl] | apply Rle_refl] | eapply loses_times; [eapply loses_add; [eapply loses_add; [apply few |
    eapply loses_add; [apply few | apply few | apply Rle_refl] | apply Rle_refl] | apply loses_const; apply Rle_refl | apply Rle_refl] |
    apply Rle_refl] |].
  assert (positive : forall p q, 0 <= p -> 0 <= Rabs q * p) by (intros; apply Rmult_le_pos; [apply Rabs_pos | assumption]).
  assert (n1 := positive E (x N_x) ltac:(lra)). assert (n2 := positive E (x N_y) ltac:(lra)).
  assert (n3 := positive F (x N_w) ltac:(lra)). assert (a1 := positive h (x a_x) ltac:(lra)).
  assert (a2 := positive h (x a_y) ltac:(lra)). assert (a3 := positive h (x a_z) ltac:(lra)). rewrite c4, cu. lra.
Qed.
Theorem delta_least more A v : only_positive x more -> (roundings more <= 31)%nat -> real x more = A ->
  loses x more (/ 10000 * (A + R1) + 100 * (h * (E + F))) -> h * (E + F) <= / 536870912 * (A + R1) ->
  computes32 x (delta_of more) v -> (1 - / 2000) * (R1 + A) <= v /\ / 2 ^ 91 <= v.
Proof.
  intros P K A_is La Le C. destruct errors_in as (h0 & hE & hF & E0 & F0). destruct R1_is as (R_is & n0 & f0).
  assert (A0 : 0 <= A) by (rewrite <- A_is; apply permanent_is; exact P).
  assert (L : loses x (delta_of more) (/ 4000 * (R1 + A))).
  { eapply loses_add; [exact loses_of_n | exact La |].
    assert (p1 := Rabs_pos (x N_w * x a_z)). assert (p2 := Rabs_pos (x N_x * x a_x)). assert (p3 := Rabs_pos (x N_y * x a_y)). lra. }
  assert (P1 : only_positive x (delta_of more)).
  { cbn -[Q2R only_positive]. cbn -[Q2R]. unfold E, F in *. rewrite ?Q2R_1. repeat split; try exact I; try (unfold Q2R; simpl; lra); try lra. exact P. }
  assert (R : (roundings (delta_of more) <= 32)%nat).
  { unfold delta_of. cbn [roundings]. change (roundings (of_n (Given N_x 0) (Given N_y 0) (Given N_w 0))) with 6%nat. lia. }
  assert (M := least_positive x _ _ v P1 R L C). change (real x (delta_of more)) with (R1 + real x more) in M. rewrite A_is in M.
  assert (p1 := Rabs_pos (x N_w * x a_z)). assert (p2 := Rabs_pos (x N_x * x a_x)). assert (p3 := Rabs_pos (x N_y * x a_y)).
  simpl. split; lra.
Qed.

(* Where a lies anywhere: R1 + A is determinant_moves' real_delta. *)
Let far_sum := real x (Add far_w (Add far_x far_y)).
Let D := real x delta_n. Let q := real x errors_sum.
Let s_1 := real x (side_of b_z b_x b_y). Let s_2 := real x (side_of c_z c_x c_y).
Lemma positive_errors e : 0 <= E -> 0 <= F -> List.In e (far_x :: far_y :: far_w :: errors_sum :: side_of b_z b_x b_y :: side_of c_z c_x c_y ::
  delta_n :: anywhere :: Add far_w (Add far_x far_y) :: nil)%list -> only_positive x e.
Proof.
  intros e0 f0 I. unfold E, F in *.
  destruct I as [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | [<- | []]]]]]]]]]; cbn -[Q2R]; rewrite ?Q2R_2; repeat split;
    try exact I; try lra; unfold Q2R; simpl; lra.
Qed.
Lemma loses_delta_n : loses x delta_n (/ 1073741824 * D + 20 * h) /\ permanent x delta_n = D /\ 2 * (q * q) <= D /\ E <= q /\ F <= q /\
  q * (s_1 + s_2) <= D /\ 0 <= s_1 /\ 0 <= s_2.
Proof.
  destruct errors_in as (h0 & hE & hF & E0 & F0). assert (pos := fun e => positive_errors e ltac:(lra) ltac:(lra)).
  assert (Pq := permanent_is x _ (pos errors_sum ltac:(cbn; tauto))). fold q in Pq.
  assert (P1 := permanent_is x _ (pos (side_of b_z b_x b_y) ltac:(cbn; tauto))). fold s_1 in P1.
  assert (P2 := permanent_is x _ (pos (side_of c_z c_x c_y) ltac:(cbn; tauto))). fold s_2 in P2.
  assert (Pd := permanent_is x _ (pos delta_n ltac:(cbn; tauto))). fold D in Pd.
  assert (q_is : q = E + E + F + F) by reflexivity. assert (hq : h <= / 274877906944 * q) by lra.
  assert (D_is : D = s_1 * q + s_2 * q + 2 * (q * q)) by (unfold D, delta_n; cbn [real]; rewrite Q2R_2; reflexivity).
  assert (k1 := Rmult_le_pos s_1 q (proj2 P1) ltac:(lra)). assert (k2 := Rmult_le_pos s_2 q (proj2 P2) ltac:(lra)).
  assert (k3 := Rmult_le_pos q q ltac:(lra) ltac:(lra)).
  destruct P1 as [P1 P10]. destruct P2 as [P2 P20]. split; [| split; [exact (proj1 Pd) |]; repeat split; lra].
  assert (two : Rabs (Q2R 2) = 2) by (rewrite Q2R_2, Rabs_pos_eq; lra).
  assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)). assert (hqq := Rmult_le_compat_r q _ _ ltac:(lra) hq).
  assert (Le : loses x errors_sum (12 * h)).
  { eapply loses_add; [eapply loses_add; [eapply loses_add; [apply loses_given; apply Rle_refl | apply loses_given; apply Rle_refl |
      apply Rle_refl] | apply loses_given; apply Rle_refl | apply Rle_refl] | apply loses_given; apply Rle_refl |]. lra. }
  assert (Ls : forall i j k, loses x (side_of i j k) (24 * h)).
  { assert (one : forall i j, loses x (Abs (Diff i j)) (6 * h)) by (intros; eapply loses_abs; [apply loses_diff; apply Rle_refl | lra]).
    intros. eapply loses_add; [apply one | eapply loses_add; [apply one | apply one | apply Rle_refl] |]. lra. }
  assert (of_side : forall e s, permanent x e = s -> 0 <= s -> (roundings e <= 32)%nat -> loses x e (24 * h) ->
    loses x (Mul e errors_sum) (/ 4294967296 * (s * q + q * q) + 3 * h)).
  { intros e s P s0 K L. apply (loses_mul x _ _ s q (24 * h) (12 * h)); auto; few_roundings; try lra.
    assert (hs := Rmult_le_compat_l s _ _ s0 hq). assert (sq := Rmult_le_pos s q s0 ltac:(lra)). lra. }
  assert (M1 := of_side _ _ P1 P10 ltac:(cbn; lia) (Ls _ _ _)).
  assert (M2 := of_side _ _ P2 P20 ltac:(cbn; lia) (Ls _ _ _)).
  assert (M3 : loses x (Mul errors_sum errors_sum) (/ 2147483648 * (q * q) + 3 * h)).
  { apply (loses_mul x _ _ q q (12 * h) (12 * h)); auto; few_roundings; lra. }
  eapply loses_add; [eapply loses_add; [exact M1 | exact M2 | apply Rle_refl] | eapply loses_times; [exact M3 | apply Rle_refl] |].
  rewrite two. lra.
Qed.
Lemma delta_is : R1 + real x anywhere = real_delta x (x N_x) (x N_y) (x N_w).
Proof.
  rewrite (proj1 R1_is). unfold real_delta, n, far, E, F. cbv [anywhere far_x far_y far_w far_of delta_n side_of errors_sum size_x size_y
    size_w size_of real]. rewrite !Rabs_mult.
  replace (Q2R (1 # 4194304)) with (/ 4194304) by (unfold Q2R; simpl; lra). rewrite Q2R_2.
  replace (/ 2 ^ 90) with (/ 1237940039285380274899124224) by (simpl; lra). ring.
Qed.
Theorem anywhere_least v : computes32 x (delta_of anywhere) v -> (1 - / 2000) * (R1 + real x anywhere) <= v /\ / 2 ^ 91 <= v.
Proof.
  destruct errors_in as (h0 & hE & hF & E0 & F0). destruct R1_is as (R_is & n0 & f0).
  destruct loses_delta_n as (Ld & Pd & D0 & q1 & q2 & D1 & s1 & s2). assert (pos := fun e => positive_errors e ltac:(lra) ltac:(lra)).
  set (A := real x anywhere).
  assert (Pf := permanent_is x _ (pos (Add far_w (Add far_x far_y)) ltac:(cbn; tauto))). fold far_sum in Pf.
  assert (Px := permanent_is x _ (pos far_x ltac:(cbn; tauto))). assert (Py := permanent_is x _ (pos far_y ltac:(cbn; tauto))).
  assert (Pw := permanent_is x _ (pos far_w ltac:(cbn; tauto))).
  assert (f_is : far_sum = far + (F + (E + E))) by (unfold far_sum, far; cbn; fold E F; ring).
  assert (fx : real x far_x = Rabs (x a_x) + E) by reflexivity. assert (fy : real x far_y = Rabs (x a_y) + E) by reflexivity.
  assert (fw : real x far_w = Rabs (x a_z) + F) by reflexivity. assert (c1 := Rabs_pos (x a_x)). assert (c2 := Rabs_pos (x a_y)).
  assert (c3 := Rabs_pos (x a_z)). assert (far_is : far = Rabs (x a_z) + (Rabs (x a_x) + Rabs (x a_y))) by reflexivity.
  set (S := s_1 + s_2) in *. assert (S0 : 0 <= S) by (unfold S; lra).
  assert (short : forall i j, List.In (i, j) sides -> Rabs (x i - x j) <= S).
  { unfold S, s_1, s_2. cbn. assert (g1 := Rabs_pos (x b_x - x a_x)). assert (g2 := Rabs_pos (x b_y - x a_y)).
    assert (g3 := Rabs_pos (x b_z - x a_z)). assert (g4 := Rabs_pos (x c_x - x a_x)). assert (g5 := Rabs_pos (x c_y - x a_y)).
    assert (g6 := Rabs_pos (x c_z - x a_z)).
    intros i j [H | [H | [H | [H | [H | [H | []]]]]]]; injection H as <- <-; lra. }
  destruct (size_in x S size_x short ltac:(cbn; tauto)) as (Lx & Ex & x0 & Rx). destruct (size_in x S size_y short ltac:(cbn; tauto)) as (Ly & Ey & y0 & Ry).
  destruct (size_in x S size_w short ltac:(cbn; tauto)) as (Lw & Ew & w0 & Rw).
  assert (A_is : A = far_sum * D + / 4194304 * (real x far_x * real x size_x + real x far_y * real x size_y + real x far_w * real x size_w)).
  { unfold A, anywhere. cbn [real]. replace (Q2R (1 # 4194304)) with (/ 4194304) by (unfold Q2R; simpl; lra). reflexivity. }
  assert (q0 : 0 <= q) by lra. assert (D00 : 0 <= D) by (assert (0 <= q * q) by (now apply Rmult_le_pos); lra).
  assert (g1 := Rmult_le_pos _ _ (proj2 Px) x0). assert (g2 := Rmult_le_pos _ _ (proj2 Py) y0). assert (g3 := Rmult_le_pos _ _ (proj2 Pw) w0).
  assert (fD := Rmult_le_pos _ _ (proj2 Pf) D00). assert (hfD : h * D <= / 68719476736 * (far_sum * D)).
  { assert (G := Rmult_le_compat_r D h (/ 68719476736 * far_sum) D00 ltac:(lra)). lra. }
  assert (hfar : h * far <= / 85070591730234615865843651857942052864 * far) by (apply Rmult_le_compat_r; lra).
  assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)). assert (hE0 := Rmult_le_pos h E ltac:(lra) ltac:(lra)).
  assert (hF0 := Rmult_le_pos h F ltac:(lra) ltac:(lra)). assert (hD0 := Rmult_le_pos h D ltac:(lra) D00).
  assert (hhD := Rmult_le_compat_r (h * D) _ _ hD0 (proj2 h0)).
  assert (hfar0 := Rmult_le_pos h far ltac:(lra) f0). assert (hf0 := Rmult_le_pos h far_sum ltac:(lra) (proj2 Pf)).
  assert (hS : h * S <= / 34359738368 * D).
  { assert (G := Rmult_le_compat_r S h (/ 68719476736 * q) S0 ltac:(lra)). lra. }
  assert (hS0 := Rmult_le_pos h S ltac:(lra) S0).
  intros C. apply (delta_least anywhere A v (pos anywhere ltac:(cbn; tauto)) ltac:(vm_compute; lia) eq_refl); [| | exact C].
  - assert (one : forall a e, loses x (far_of a e) (6 * h)).
    { intros. eapply loses_add; [eapply loses_abs; [apply loses_given; apply Rle_refl | apply Rle_refl] | apply loses_given; apply Rle_refl |]. lra. }
    assert (M1 : loses x (Mul (Add far_w (Add far_x far_y)) delta_n) (/ 100000000 * (far_sum * D) + 21 * (h * far_sum) + 3 * h)).
    { apply (loses_mul x _ _ far_sum D (24 * h) (/ 1073741824 * D + 20 * h)); try tauto; few_roundings; try lra.
      eapply loses_add; [apply one | eapply loses_add; [apply one | apply one | apply Rle_refl] |]. lra. }
    assert (of_size : forall f s, permanent x f = real x f -> h <= / 68719476736 * real x f -> real x f <= far_sum -> (roundings f <= 32)%nat ->
      loses x f (6 * h) -> permanent x s = real x s -> 0 <= real x s -> (roundings s <= 32)%nat -> loses x s (h * (24 * S + 20)) ->
      loses x (Mul f s) (/ 100000000 * (real x f * real x s) + / 100000000 * (far_sum * D) + 21 * (h * far_sum) + 3 * h)).
    { intros f s Pf' hf ff Kf Lf Ps s0 Ks L. apply (loses_mul x _ _ (real x f) (real x s) (6 * h) (h * (24 * S + 20))); auto; try lra.
      assert (fs := Rmult_le_compat_r _ _ _ s0 hf). assert (fS := Rmult_le_compat (real x f) far_sum (h * S) _ ltac:(lra) hS0 ff hS).
      assert (fh := Rmult_le_compat_r h _ _ ltac:(lra) ff). assert (hhS := Rmult_le_compat_r (h * S) _ _ hS0 (proj2 h0)).
      assert (fhS := Rmult_le_compat_r (h * S) _ _ hS0 hf).
      assert (fs0 := Rmult_le_pos (real x f) _ ltac:(lra) s0). lra. }
    assert (N1 := of_size far_x size_x (proj1 Px) ltac:(lra) ltac:(lra) ltac:(cbn; lia) (one _ _) Ex x0 Rx Lx).
    assert (N2 := of_size far_y size_y (proj1 Py) ltac:(lra) ltac:(lra) ltac:(cbn; lia) (one _ _) Ey y0 Ry Ly).
    assert (N3 := of_size far_w size_w (proj1 Pw) ltac:(lra) ltac:(lra) ltac:(cbn; lia) (one _ _) Ew w0 Rw Lw).
    assert (c4 : Rabs (Q2R (1 # 4194304)) = / 4194304) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
    assert (p1 := Rabs_pos (x N_w * x a_z)). assert (p2 := Rabs_pos (x N_x * x a_x)). assert (p3 := Rabs_pos (x N_y * x a_y)).
    assert (hf_is : h * far_sum = h * far + (h * F + 2 * (h * E))) by (rewrite f_is; ring).
    eapply loses_add; [exact M1 | eapply loses_times; [eapply loses_add; [eapply loses_add; [exact N1 | exact N2 | apply Rle_refl] | exact N3 |
      apply Rle_refl] | apply Rle_refl] |]. rewrite c4, A_is, R_is. lra.
  - assert (few : forall e, 0 <= e -> e <= q -> e <= far_sum -> h * e <= / 1073741824 * (A + R1)).
    { intros e e0 eq ef. assert (p1 := Rabs_pos (x N_w * x a_z)). assert (p2 := Rabs_pos (x N_x * x a_x)). assert (p3 := Rabs_pos (x N_y * x a_y)).
      destruct (Rle_dec e 1) as [small | large].
      - assert (G := Rmult_le_compat_l h _ _ ltac:(lra) small). lra.
      - assert (G := Rmult_le_compat 1 e 1 e ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)).
        assert (G2 := Rmult_le_compat e q e q e0 e0 eq eq). assert (G3 := Rmult_le_compat e far_sum 1 D e0 ltac:(lra) ef ltac:(lra)).
        assert (G4 := Rmult_le_compat_r e h 1 e0 ltac:(lra)). assert (G5 := Rmult_le_compat_r e _ _ e0 (proj2 h0)). lra. }
    assert (G1 := few E ltac:(lra) q1 ltac:(lra)). assert (G2 := few F ltac:(lra) q2 ltac:(lra)). lra.
Qed.
End Delta.

(* ---- N . p and det ---- *)
Section Moved.
Open Scope R_scope.

(* N . p is the cross product of two sides relative to p, r and s; each coordinate is off by at most e and f. *)
Lemma cross_moves r_x r_y s_x s_y p_x p_y q_x q_y rho sigma e f :
  Rabs r_x <= rho -> Rabs r_y <= rho -> Rabs s_x <= sigma -> Rabs s_y <= sigma ->
  Rabs (p_x - r_x) <= e -> Rabs (p_y - r_y) <= e -> Rabs (q_x - s_x) <= f -> Rabs (q_y - s_y) <= f ->
  Rabs ((p_x * q_y - p_y * q_x) - (r_x * s_y - r_y * s_x)) <= (rho * f + sigma * e + e * f) * 2.
Proof.
  assert (moves : forall p q p' q' P Q, Rabs p <= P -> Rabs q <= Q -> Rabs (p' - p) <= e -> Rabs (q' - q) <= f ->
    Rabs (p' * q' - p * q) <= P * f + Q * e + e * f).
  { intros p q p' q' P Q HP HQ Hp Hq.
    replace (p' * q' - p * q) with ((p' - p) * (q' - q) + (p * (q' - q) + q * (p' - p))) by ring.
    assert (T := Rabs_triang ((p' - p) * (q' - q)) (p * (q' - q) + q * (p' - p))).
    assert (U := Rabs_triang (p * (q' - q)) (q * (p' - p))). rewrite !Rabs_mult in *.
    assert (A := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Hp Hq).
    assert (B := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) HP Hq).
    assert (C := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) HQ Hp). lra. }
  intros R1 R2 S1 S2 P1 P2 Q1 Q2.
  assert (A := moves _ _ _ _ _ _ R1 S2 P1 Q2). assert (B := moves _ _ _ _ _ _ R2 S1 P2 Q1).
  apply between in A. apply between in B. apply Rabs_le. lra.
Qed.

(* Z = N . p / det: n and D are the computed ones, n_p is n . p at the computed point, m_p the real N . p at the real
  point,
   E the real determinant; L is at least |n_p / D|. *)
Theorem quotient_moves n_p m_p D E d_p d_D L :
  Rabs (m_p - n_p) <= d_p -> Rabs (E - D) <= d_D -> Rabs (n_p / D) <= L -> d_D < Rabs D ->
  Rabs (m_p / E - n_p / D) <= (d_p + L * d_D) / (Rabs D - d_D).
Proof.
  intros Hp HD HL steep.
  assert (D0 : D <> 0) by (intros ->; rewrite Rabs_R0 in steep; assert (S := Rabs_pos (E - 0)); lra).
  assert (least : Rabs D - d_D <= Rabs E).
  { assert (T := Rabs_triang_inv D (D - E)). replace (D - (D - E)) with E in T by ring. rewrite Rabs_minus_sym in HD.
    lra. }
  assert (E0 : E <> 0) by (intros ->; rewrite Rabs_R0 in least; lra).
  replace (m_p / E - n_p / D) with (((m_p - n_p) + - (n_p / D * (E - D))) * / E) by (field; auto).
  rewrite Rabs_mult, Rabs_inv. apply Rmult_le_compat; auto using Rabs_pos.
  - left. apply Rinv_0_lt_compat, Rabs_pos_lt, E0.
  - eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, Rabs_mult.
    assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) HL HD). lra.
  - apply Rinv_le_contravar; lra.
Qed.
End Moved.

(* ---- N . a where a lies in the grid ---- *)
Section InGrid.
Variable x : nat -> R.
Open Scope R_scope.
Local Notation h := h32.
Definition grid_e := let E := Given error 0 in let F := Given error_w 0 in
  Add (Add (Add (Add E (Mul reach_sum F)) E) (Mul reach_sum F)) (Mul (Add F F) (Given quotient_6 5)).
Definition grid_rho greatest w := Add (Given greatest 0) (Mul (Abs (Diff w a_z)) (Given quotient_6 5)).
Definition grid_reach := Add reach_sum (Given quotient_6 5).
Definition grid_sum := Add (Times (1 # 4194304) (Add size_w (Add (Mul size_y grid_reach) (Mul size_x grid_reach))))
  (Times 2 (Add (Add (Mul grid_e (grid_rho greater_11 b_z)) (Mul grid_e (grid_rho greater_14 c_z))) (Mul grid_e grid_e))).
Lemma in_grid_is : in_grid = Mul (Add (Given a_z 0) (Given error_w 0)) grid_sum.
Proof. reflexivity. Qed.

Let r := x point_error + x side. Let E := x error. Let F := x error_w. Let p := x quotient_6.
Hypotheses (side_in : 1 <= x side <= 2 ^ 16) (point_error_in : 0 <= x point_error <= 2 ^ 16).
Hypotheses (E_in : / 2 ^ 90 <= E) (F_in : / 2 ^ 90 <= F) (a_z_in : 0 <= x a_z) (p_in : 0 <= p).
Hypotheses (greater_11_in : 0 <= x greater_11) (greater_14_in : 0 <= x greater_14).
Let e := E + r * F + E + r * F + (F + F) * p.
Let rho_1 := x greater_11 + Rabs (x b_z - x a_z) * p.
Let rho_2 := x greater_14 + Rabs (x c_z - x a_z) * p.
Let W := x a_z + F. Let f := r + p.
Variable S : R.
Hypothesis S_in : S <= 4 * r * (rho_1 + rho_2).
Hypothesis short : forall i j, List.In (i, j) sides -> Rabs (x i - x j) <= S.
Hypothesis position_in : W * p <= 10 * e + x a_z.
Let R1 := real x (of_n (Given N_x 0) (Given N_y 0) (Given N_w 0)).
Let G := real x grid_sum.
Lemma h_r_in : 0 < h <= / 85070591730234615865843651857942052864 /\ 1 <= r <= 131072 /\ 0 <= x point_error <= r /\
  h * r <= / 68719476736 * e /\ h <= / 68719476736 * e /\ h * F <= / 68719476736 * e /\ h * p <= / 68719476736 * e /\
  F <= e /\ E <= e /\ r * F <= e /\ F * p <= e /\ 0 <= e /\ h <= / 68719476736 * E /\ h <= / 68719476736 * F.
Proof.
  destruct h32_powers as [[h0 h1] _]. assert (k1 : h <= / 68719476736 * E) by (simpl in *; lra).
  assert (k2 : h <= / 68719476736 * F) by (simpl in *; lra).
  assert (f0 : 0 <= F) by (simpl in *; lra). assert (e0 : 0 <= E) by (simpl in *; lra). simpl in h1.
  assert (r0 : 1 <= r <= 131072) by (unfold r; simpl in *; lra). assert (p0 : 0 <= x point_error <= r) by (unfold r; lra).
  assert (K := Rmult_le_compat_r r _ _ ltac:(lra) k2). assert (K2 := Rmult_le_compat_r F 1 r f0 ltac:(lra)).
  assert (K3 := Rmult_le_compat_r p _ _ p_in k2). assert (K4 := Rmult_le_pos F p f0 p_in).
  assert (K5 := Rmult_le_compat_r F h (/ 68719476736) f0 ltac:(lra)). unfold e. repeat split; lra.
Qed.
(* That a_w times the error of a's position is as small: where its quotient is computed. *)
Lemma position_has_it v w : computes32 x quotient_6_over v -> computes32 x quotient_6_under w -> 0 < w -> Rabs (p - v / w) <= h ->
  W * p <= 10 * e + x a_z.
Proof.
  clear position_in. intros Cv Cw w0 H. destruct h_r_in as (h0 & r0 & p0 & e2 & e3 & e5 & e6 & Fe & Ee & rF & Fp & e_0 & hE & hF).
  assert (F0 : 0 <= F) by lra. assert (hr0 := Rmult_le_pos h r ltac:(lra) ltac:(lra)). assert (hF0 := Rmult_le_pos h F ltac:(lra) F0).
  assert (hr := Rmult_le_compat_l h _ _ ltac:(lra) (proj1 r0)). assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)).
  assert (rF0 := Rmult_le_pos r F ltac:(lra) F0).
  assert (P : permanent x quotient_6_over = E + r * F) by
    (refine (proj1 (permanent_is x quotient_6_over _)); cbn; unfold E, F in *; repeat split; lra).
  assert (L : loses x quotient_6_over (h * (3 * r + 7 * F + 10))).
  { eapply loses_add; [apply loses_given; apply Rle_refl | apply (loses_mul x _ _ r F (5 * h) h); few_roundings |].
    - cbn. unfold r. rewrite !Rabs_pos_eq; lra.
    - cbn. unfold F in *. rewrite Rabs_pos_eq; lra.
    - apply (loses_add x _ _ h h); try (apply loses_given); lra.
    - apply loses_given; lra.
    - apply Rle_refl.
    - lra. }
  assert (v1 : v <= 102 / 100 * e).
  { apply near32 in Cv. rewrite P in Cv. change (real x quotient_6_over) with (E + r * F) in Cv. unfold loses in L.
    assert (K := alpha_32 (roundings quotient_6_over) ltac:(vm_compute; lia)).
    assert (eF : 0 <= F * p) by (now apply Rmult_le_pos). assert (e_is : e = 2 * (E + r * F) + 2 * (F * p)) by (unfold e; ring).
    assert (K2 := Rmult_le_compat_r (E + r * F) _ _ ltac:(lra) (proj2 K)). apply between in Cv. lra. }
  destruct (Rle_dec (x a_z) (2 * F)) as [near | far].
  - assert (K := Rmult_le_compat_r p _ _ p_in near). unfold W. lra.
  - apply step32_diff in Cw. fold F in Cw. rewrite (Rabs_pos_eq (x a_z - F)) in Cw by lra. apply between in Cw, H.
    assert (aw : x a_z * / w <= 21 / 10).
    { apply Rmult_le_reg_r with w; [exact w0 |]. rewrite Rmult_assoc, Rinv_l by lra. lra. }
    assert (aw0 : 0 <= x a_z * / w) by (apply Rmult_le_pos; [exact a_z_in | left; now apply Rinv_0_lt_compat]).
    assert (K := Rmult_le_compat_l (x a_z) p (v / w + h) a_z_in ltac:(lra)). assert (K2 := Rmult_le_compat_r p _ _ p_in (Rlt_le _ _ (Rnot_le_lt _ _ far))).
    assert (K3 := Rmult_le_compat_l _ _ _ aw0 v1). assert (K4 := Rmult_le_compat_r e _ _ e_0 aw).
    assert (ah := Rmult_le_compat_l (x a_z) h (/ 1000) a_z_in ltac:(lra)). unfold W, Rdiv in *. lra.
Qed.
Lemma G_is : G = / 4194304 * (real x size_w + (real x size_y * f + real x size_x * f)) + 2 * (e * rho_1 + e * rho_2 + e * e).
Proof.
  unfold G, grid_sum. cbn [real]. rewrite Q2R_2. replace (Q2R (1 # 4194304)) with (/ 4194304) by (unfold Q2R; simpl; lra). reflexivity.
Qed.
Lemma rhos : (permanent x (grid_rho greater_11 b_z) = rho_1 /\ 0 <= rho_1) /\ (permanent x (grid_rho greater_14 c_z) = rho_2 /\ 0 <= rho_2).
Proof. split; apply permanent_is; cbn; fold p; tauto. Qed.
Lemma loses_grid : loses x grid_sum (/ 20000 * G + / 40000 * (h * f) + 40 * h).
Proof.
  rewrite G_is. destruct h_r_in as (h0 & r0 & p0 & e2 & e3 & e5 & e6 & Fe & Ee & rF & Fp & e_0 & hE & hF).
  assert (S0 : 0 <= S) by (eapply Rle_trans; [apply Rabs_pos | apply (short b_x a_x); cbn; tauto]).
  destruct (size_in x S size_x short ltac:(cbn; tauto)) as (Lx & Px & x0 & Rx). destruct (size_in x S size_y short ltac:(cbn; tauto)) as (Ly & Py & y0 & Ry).
  destruct (size_in x S size_w short ltac:(cbn; tauto)) as (Lw & Pw & w0 & Rw). destruct rhos as [[P1 q1] [P2 q2]].
  set (q := rho_1 + rho_2) in *. assert (q_0 : 0 <= q) by (unfold q; lra).
  assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)). assert (hS0 := Rmult_le_pos h S ltac:(lra) S0).
  assert (hp0 := Rmult_le_pos h p ltac:(lra) p_in). assert (hF0 := Rmult_le_pos h F ltac:(lra) ltac:(lra)).
  assert (hr0 := Rmult_le_pos h r ltac:(lra) ltac:(lra)). assert (F0 : 0 <= F) by lra.
  assert (LR : loses x reach_sum (5 * h)) by (apply (loses_add x _ _ h h); try (apply loses_given); lra).
  assert (PR : permanent x reach_sum = r) by (cbn; unfold r; rewrite !Rabs_pos_eq; lra).
  assert (PF : Rabs (x error_w) <= F) by (unfold F in *; rewrite Rabs_pos_eq; lra).
  assert (Pp : Rabs (x quotient_6) <= p) by (unfold p in *; rewrite Rabs_pos_eq; lra).
  assert (LF : loses x (Mul reach_sum (Given error_w 0)) (h * (2 * r + 6 * F + 3))).
  { assert (hr := Rmult_le_compat_l h _ _ ltac:(lra) (proj1 r0)).
    apply (loses_mul x _ _ r F (5 * h) h); try exact LR; try (apply loses_given; lra); few_roundings; try exact PF; lra. }
  assert (L2 : loses x (Mul (Add (Given error_w 0) (Given error_w 0)) (Given quotient_6 5)) (h * (3 * F + 6 * p + 3))).
  { apply (loses_mul x _ _ (F + F) p (5 * h) h); try (apply loses_given; lra); few_roundings; try (cbn; lra); try exact Pp; try lra.
    apply (loses_add x _ _ h h); try (apply loses_given); lra. }
  assert (Le : loses x grid_e (/ 1073741824 * e)).
  { eapply loses_add; [eapply loses_add; [eapply loses_add; [eapply loses_add; [apply loses_given; apply Rle_refl | exact LF | apply Rle_refl] |
      apply loses_given; apply Rle_refl | apply Rle_refl] | exact LF | apply Rle_refl] | exact L2 |]. lra. }
  assert (Pe : permanent x grid_e = e).
  { refine (proj1 (permanent_is x grid_e _)). cbn. unfold E, F, p in *. repeat split; lra. }
  assert (Re : roundings grid_e = 8%nat) by (vm_compute; reflexivity).
  assert (eq := Rmult_le_pos e q e_0 q_0). assert (ee := Rmult_le_pos e e e_0 e_0).
  set (l := h * (2 * S + 8 * p + 10)) in *.
  assert (hrq : h * (4 * r * q) <= / 1000000000000000 * q).
  { assert (K := Rmult_le_compat_r q (h * (4 * r)) (/ 1000000000000000) q_0).
    assert (K2 := Rmult_le_compat h (/ 85070591730234615865843651857942052864) r 131072 ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)).
    specialize (K ltac:(lra)). lra. }
  assert (hS := Rmult_le_compat_l h _ _ ltac:(lra) S_in). fold q in hS.
  assert (l_in : 0 <= l <= / 100000000000000 * q + / 1000000000 * e).
  { unfold l. split; [apply Rmult_le_pos; lra |]. lra. }
  assert (el := Rmult_le_compat_l e _ _ e_0 (proj2 l_in)). assert (el0 := Rmult_le_pos _ _ e_0 (proj1 l_in)).
  assert (of_rho : forall g w rho, List.In (w, a_z) sides -> permanent x (grid_rho g w) = rho -> 0 <= rho <= q ->
    loses x (Mul grid_e (grid_rho g w)) (/ 100000000 * (e * q + e * e) + 3 * h)).
  { intros g w rho I P q0. apply (loses_mul x _ _ e rho (/ 1073741824 * e) l); auto; try (rewrite Re; lia); few_roundings; try lra.
    - eapply loses_add; [apply loses_given; apply Rle_refl | apply (loses_mul x _ _ S p (6 * h) h); few_roundings;
        [exact (short _ _ I) | exact Pp | eapply loses_abs; [apply loses_diff; apply Rle_refl | lra] | apply loses_given; lra | apply Rle_refl] |].
      unfold l. lra.
    - assert (er := Rmult_le_compat_l e _ _ e_0 (proj2 q0)). lra. }
  assert (M1 := of_rho greater_11 b_z _ ltac:(cbn; tauto) P1 ltac:(unfold q; lra)).
  assert (M2 := of_rho greater_14 c_z _ ltac:(cbn; tauto) P2 ltac:(unfold q; lra)).
  assert (M3 : loses x (Mul grid_e grid_e) (/ 100000000 * (e * e) + 3 * h)).
  { apply (loses_mul x _ _ e e (/ 1073741824 * e) (/ 1073741824 * e)); auto; try (rewrite Re; lia); try lra. }
  set (s_x := real x size_x) in *. set (s_y := real x size_y) in *. set (s_w := real x size_w) in *.
  set (k := h * (24 * S + 20)) in *. assert (f0 : 1 <= f) by (unfold f; lra).
  assert (k_in : 0 <= k <= 24 * (h * (4 * r * q)) + 20 * h).
  { unfold k. split; [apply Rmult_le_pos; lra |]. lra. }
  assert (hf : h * f <= / 34359738368 * e) by (unfold f; lra). assert (hf0 := Rmult_le_pos h f ltac:(lra) ltac:(lra)).
  assert (hrr : h * (4 * r * q) * f <= / 50000 * (e * q)).
  { assert (rq := Rmult_le_pos r q ltac:(lra) q_0). assert (K := Rmult_le_compat_r (4 * (r * q)) _ _ ltac:(lra) hf).
    assert (K2 := Rmult_le_compat_l (e * q) _ _ eq (proj2 r0)). lra. }
  assert (kf : 0 <= k * f <= 24 / 50000 * (e * q) + 20 * (h * f)).
  { split; [apply Rmult_le_pos; lra |]. assert (K := Rmult_le_compat_r f _ _ ltac:(lra) (proj2 k_in)). lra. }
  assert (kq : k <= k * f) by (assert (K := Rmult_le_compat_l k _ _ ltac:(lra) f0); lra).
  assert (Lf : loses x grid_reach (9 * h)) by (eapply loses_add; [exact LR | apply loses_given; apply Rle_refl | lra]).
  assert (Pf : permanent x grid_reach <= f) by (unfold grid_reach; cbn [permanent]; rewrite PR; unfold f; lra).
  assert (of_size : forall s v, permanent x s = v -> 0 <= v -> (roundings s <= 32)%nat -> loses x s k ->
    loses x (Mul s grid_reach) (/ 1000000 * (v * f) + 2 * (k * f) + 3 * h)).
  { intros s v P v0 K L. apply (loses_mul x _ _ v f k (9 * h)); auto; few_roundings; try lra.
    assert (vr := Rmult_le_compat_l v _ _ v0 f0). assert (vh := Rmult_le_compat_l v _ _ v0 (proj2 h0)).
    assert (kh := Rmult_le_compat_l k _ _ (proj1 k_in) (proj2 h0)). lra. }
  assert (N1 := of_size _ _ Py y0 Ry Ly). assert (N2 := of_size _ _ Px x0 Rx Lx).
  assert (yr := Rmult_le_pos _ f y0 ltac:(lra)). assert (xr := Rmult_le_pos _ f x0 ltac:(lra)).
  assert (two : Rabs (Q2R 2) = 2) by (rewrite Q2R_2, Rabs_pos_eq; lra).
  assert (cp : Rabs (Q2R (1 # 4194304)) = / 4194304) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  assert (eq_is : e * q = e * rho_1 + e * rho_2) by (unfold q; ring).
  eapply loses_add; [eapply loses_times; [eapply loses_add; [exact Lw | eapply loses_add; [exact N1 | exact N2 | apply Rle_refl] | apply Rle_refl] | apply Rle_refl] |
    eapply loses_times; [eapply loses_add; [eapply loses_add; [exact M1 | exact M2 | apply Rle_refl] | exact M3 | apply Rle_refl] | apply Rle_refl] |].
  rewrite two, cp. lra.
Qed.
Let A := real x in_grid.
Lemma few_in_grid : h * e <= / 68719476736 * (A + R1) /\ A = W * G /\ 0 <= W /\ F <= W /\ 2 * (e * (rho_1 + rho_2)) <= G /\ 0 <= R1 /\
  / 1237940039285380274899124224 * (x a_z + 1) <= R1.
Proof.
  destruct h_r_in as (h0 & r0 & p0 & e2 & e3 & e5 & e6 & Fe & Ee & rF & Fp & e_0 & hE & hF).
  assert (A_is : A = W * G) by reflexivity. destruct rhos as [[P1 q1] [P2 q2]].
  assert (ee := Rmult_le_pos e e e_0 e_0). assert (e1 := Rmult_le_pos e _ e_0 q1). assert (e4 := Rmult_le_pos e _ e_0 q2).
  destruct (size_in x S size_x short ltac:(cbn; tauto)) as (_ & _ & x0 & _). destruct (size_in x S size_y short ltac:(cbn; tauto)) as (_ & _ & y0 & _).
  destruct (size_in x S size_w short ltac:(cbn; tauto)) as (_ & _ & w0 & _). assert (f0 : 0 <= f) by (unfold f; lra).
  assert (yr := Rmult_le_pos _ f y0 f0). assert (xr := Rmult_le_pos _ f x0 f0). assert (GG := G_is).
  assert (R := proj1 (R1_is x E_in F_in)). fold R1 in R. destruct (proj2 (R1_is x E_in F_in)) as [n0 _]. fold E F in R, n0.
  assert (z1 := Rabs_pos (x N_w * x a_z)). assert (z2 := Rabs_pos (x N_x * x a_x)). assert (z3 := Rabs_pos (x N_y * x a_y)).
  assert (c1 := Rabs_pos (x a_x)). assert (c2 := Rabs_pos (x a_y)). rewrite (Rabs_pos_eq (x a_z)) in R by exact a_z_in.
  assert (W0 : F <= W) by (unfold W; lra). assert (F0 : 0 <= F) by lra.
  assert (R2 : / 1237940039285380274899124224 * (x a_z + 1) <= R1) by lra.
  split; [| repeat split; lra].
  assert (WG := Rmult_le_compat F W (2 * (e * e)) G F0 ltac:(lra) W0 ltac:(lra)).
  destruct (Rle_dec e 1) as [small | large].
  - assert (K := Rmult_le_compat_l h _ _ ltac:(lra) small). assert (0 <= F * (2 * (e * e))) by (apply Rmult_le_pos; lra). lra.
  - assert (K := Rmult_le_compat_r e _ _ e_0 hF). assert (K2 := Rmult_le_compat_l (F * e) 1 e ltac:(apply Rmult_le_pos; lra) ltac:(lra)).
    assert (Fe0 := Rmult_le_pos F e F0 e_0). lra.
Qed.
Theorem in_grid_least v : computes32 x (delta_of in_grid) v -> (1 - / 2000) * (R1 + A) <= v /\ / 2 ^ 91 <= v.
Proof.
  destruct h_r_in as (h0 & r0 & p0 & e2 & e3 & e5 & e6 & Fe & Ee & rF & Fp & e_0 & hE & hF).
  destruct few_in_grid as (he & A_is & W0 & FW & _ & R0 & R2). intros C.
  assert (P : only_positive x in_grid).
  { cbn -[Q2R]. rewrite Q2R_2. unfold E, F, p in *. repeat split; try exact I; try lra; unfold Q2R; simpl; lra. }
  assert (F0 : 0 <= F) by lra. assert (G0 : 0 <= G) by (apply permanent_is; apply P).
  assert (hEe := Rmult_le_compat_l h _ _ ltac:(lra) Ee). assert (hFe := Rmult_le_compat_l h _ _ ltac:(lra) Fe).
  assert (WG := Rmult_le_pos W G W0 G0).
  apply (delta_least x E_in F_in in_grid A v P ltac:(vm_compute; lia) eq_refl); [| fold E F R1; lra | exact C]. fold E F R1.
  apply (loses_mul x _ _ W G (5 * h) (/ 20000 * G + / 40000 * (h * f) + 40 * h)); few_roundings.
  - cbn. unfold W. rewrite (Rabs_pos_eq (x a_z)), (Rabs_pos_eq (x error_w)) by (assumption || exact F0). apply Rle_refl.
  - apply Req_le. apply permanent_is. apply P.
  - apply (loses_add x _ _ h h); try (apply loses_given); lra.
  - exact loses_grid.
  - assert (hW : h * W = h * x a_z + h * F) by (unfold W; ring). assert (hf : h * f = h * r + h * p) by (unfold f; ring).
    assert (Whf : W * (h * f) = h * W * r + h * (W * p)) by (unfold f; ring).
    assert (ha : h * x a_z <= / 85070591730234615865843651857942052864 * x a_z) by (apply Rmult_le_compat_r; lra).
    assert (ha0 := Rmult_le_pos h _ ltac:(lra) a_z_in). assert (hF0 := Rmult_le_pos h F ltac:(lra) F0).
    assert (hE0 := Rmult_le_pos h E ltac:(lra) ltac:(lra)).
    assert (Wr := Rmult_le_compat_l (h * W) _ _ ltac:(lra) (proj2 r0)). assert (Wp := Rmult_le_compat_l h _ _ ltac:(lra) position_in).
    assert (hG := Rmult_le_compat_r G _ _ G0 (Rle_trans _ _ _ hF (Rmult_le_compat_l (/ 68719476736) _ _ ltac:(lra) FW))).
    assert (hG0 := Rmult_le_pos h G ltac:(lra) G0).
    assert (hhG := Rmult_le_compat_r (h * G) _ _ hG0 (proj2 h0)). assert (hh := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 h0)).
    assert (hfe : h * f <= / 34359738368 * e) by lra. assert (hhf := Rmult_le_compat_l h _ _ ltac:(lra) hfe). rewrite A_is in *. lra.
Qed.
Section Moved.
Variables X1 Y1 W1 X2 Y2 W2 A_x A_y A_w : R.
Let near P Q m := Rabs (P - Q) <= m.
Hypotheses (x1_near : near X1 (x b_x - x a_x) (2 * E)) (x2_near : near X2 (x c_x - x a_x) (2 * E)).
Hypotheses (y1_near : near Y1 (x b_y - x a_y) (2 * E)) (y2_near : near Y2 (x c_y - x a_y) (2 * E)).
Hypotheses (w1_near : near W1 (x b_z - x a_z) (2 * F)) (w2_near : near W2 (x c_z - x a_z) (2 * F)).
Hypotheses (a_x_near : near A_x (x a_x) E) (a_y_near : near A_y (x a_y) E) (a_w_near : near A_w (x a_z) F).
(* P: the real a's place in the grid. *)
Variables P_x P_y : R.
Hypotheses (A_w0 : 0 <= A_w) (A_x_is : A_x = A_w * P_x) (A_y_is : A_y = A_w * P_y) (P_x_in : Rabs P_x <= f) (P_y_in : Rabs P_y <= f).
Let in_rho v a w P rho := Rabs (x v - x a - P * (x w - x a_z)) <= rho.
Hypotheses (x1_in : in_rho b_x a_x b_z P_x rho_1) (y1_in : in_rho b_y a_y b_z P_y rho_1).
Hypotheses (x2_in : in_rho c_x a_x c_z P_x rho_2) (y2_in : in_rho c_y a_y c_z P_y rho_2).
Theorem in_grid_moves v : computes32 x quotient_1_over (x N_x) -> computes32 x quotient_2_over (x N_y) ->
  computes32 x quotient_3_over (x N_w) -> computes32 x (determinant_of (Given N_x 0) (Given N_y 0) (Given N_w 0)) v ->
  Rabs ((Y1 * W2 - W1 * Y2) * A_x + (W1 * X2 - X1 * W2) * A_y + (X1 * Y2 - Y1 * X2) * A_w - v) <= (1 + / 2 ^ 9) * (R1 + A).
Proof.
  intros Cx Cy Cw C. destruct (step32_fma _ _ _ _ _ C) as (n_x & a & t & Cn & Ca & C1 & T1). apply given32_is in Cn, Ca. subst a n_x.
  destruct (step32_fma _ _ _ _ _ C1) as (n_y & a & t' & Cn & Ca & C2 & T2). apply given32_is in Cn, Ca. subst a n_y.
  destruct (step32_mul _ _ _ _ C2) as (n_w & a & Cn & Ca & T3). apply given32_is in Cn, Ca. subst a n_w. clear C C1 C2.
  destruct h_r_in as (h0 & r0 & p0 & e2 & e3 & e5 & e6 & Fe & Ee & rF & Fp & e_0 & hE & hF).
  destruct few_in_grid as (he & A_is & W0 & FW & G2 & R0 & R2). destruct rhos as [[_ q1] [_ q2]].
  assert (at_side : forall i j, List.In (i, j) sides -> Rabs (x i - x j) <= S) by exact short.
  assert (normal := fun q v I => normals_near x S (at_side b_x a_x ltac:(cbn; tauto)) (at_side b_y a_y ltac:(cbn; tauto))
    (at_side b_z a_z ltac:(cbn; tauto)) (at_side c_x a_x ltac:(cbn; tauto)) (at_side c_y a_y ltac:(cbn; tauto))
    (at_side c_z a_z ltac:(cbn; tauto)) q v I).
  assert (N1 := normal quotient_1_over _ ltac:(cbn; tauto) Cx). assert (N2 := normal quotient_2_over _ ltac:(cbn; tauto) Cy). assert (N3 := normal quotient_3_over _ ltac:(cbn; tauto) Cw).
  (* N . P of the computed sides, and of the real ones. *)
  assert (moved : forall X0 Z0 x0 z0 P, near X0 x0 (2 * E) -> near Z0 z0 (2 * F) -> Rabs P <= f -> Rabs ((X0 - P * Z0) - (x0 - P * z0)) <= e).
  { unfold near. intros X0 Z0 x0 z0 P HX HZ HP. replace ((X0 - P * Z0) - (x0 - P * z0)) with ((X0 - x0) + - (P * (Z0 - z0))) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, Rabs_mult.
    assert (K := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) HP HZ). unfold e, f in *. lra. }
  assert (M := cross_moves _ _ _ _ _ _ _ _ rho_1 rho_2 e e x1_in y1_in x2_in y2_in (moved _ _ _ _ P_x x1_near w1_near P_x_in)
    (moved _ _ _ _ P_y y1_near w1_near P_y_in) (moved _ _ _ _ P_x x2_near w2_near P_x_in) (moved _ _ _ _ P_y y2_near w2_near P_y_in)).
  set (n1 := real x quotient_1_over) in *. set (n2 := real x quotient_2_over) in *. set (n3 := real x quotient_3_over) in *.
  assert (K1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N1 P_x_in). assert (K2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N2 P_y_in).
  rewrite <- Rabs_mult in K1, K2. assert (GG := G_is). set (lost := normal_loses S) in *.
  replace (permanent x quotient_1_over) with (real x size_x) in * by (cbn; rewrite !Rabs_mult; reflexivity).
  replace (permanent x quotient_2_over) with (real x size_y) in * by (cbn; rewrite !Rabs_mult; ring).
  replace (permanent x quotient_3_over) with (real x size_w) in * by (cbn; rewrite !Rabs_mult; reflexivity).
  destruct (size_in x S size_x short ltac:(cbn; tauto)) as (_ & _ & x0 & _). destruct (size_in x S size_y short ltac:(cbn; tauto)) as (_ & _ & y0 & _).
  destruct (size_in x S size_w short ltac:(cbn; tauto)) as (_ & _ & w0 & _). assert (f0 : 1 <= f) by (unfold f; lra).
  assert (yr := Rmult_le_pos _ f y0 ltac:(lra)). assert (xr := Rmult_le_pos _ f x0 ltac:(lra)).
  assert (k1 := Rmult_le_pos _ _ e_0 q1). assert (k2 := Rmult_le_pos _ _ e_0 q2). assert (k3 := Rmult_le_pos _ _ e_0 e_0).
  assert (S0 : 0 <= S) by (eapply Rle_trans; [apply Rabs_pos | apply (short b_x a_x); cbn; tauto]).
  assert (l0 : 0 <= lost) by (unfold lost, normal_loses; apply Rmult_le_pos; lra).
  assert (lf := Rmult_le_compat_l lost _ _ l0 f0).
  set (Q := (Y1 * W2 - W1 * Y2) * P_x + (W1 * X2 - X1 * W2) * P_y + (X1 * Y2 - Y1 * X2)).
  assert (Q_near : Rabs (Q - (x N_x * P_x + x N_y * P_y + x N_w)) <= (1 + / 1048576) * G + 3 * (lost * f)).
  { replace (Q - (x N_x * P_x + x N_y * P_y + x N_w)) with (Q - (n1 * P_x + n2 * P_y + n3) -
      ((x N_x - n1) * P_x + (x N_y - n2) * P_y + (x N_w - n3))) by ring.
    match type of M with Rabs ?m <= _ => replace m with (Q - (n1 * P_x + n2 * P_y + n3)) in M by (unfold Q, n1, n2, n3; cbn; ring) end.
    apply between in M, K1, K2, N3. apply Rabs_le. lra. }
  (* What underflow takes of N. *)
  assert (q0 : 0 <= rho_1 + rho_2) by lra. assert (eq := Rmult_le_pos _ _ e_0 q0).
  assert (hf : h * f <= / 34359738368 * e) by (unfold f; lra). assert (hf0 := Rmult_le_pos h f ltac:(lra) ltac:(lra)).
  assert (lf2 : lost * f <= / 3000 * (e * (rho_1 + rho_2)) + 8 * (h * f)).
  { assert (L1 := Rmult_le_compat_r (h * f) _ _ hf0 S_in). assert (rq := Rmult_le_pos r _ ltac:(lra) q0).
    assert (L2 := Rmult_le_compat_r (4 * (r * (rho_1 + rho_2))) _ _ ltac:(lra) hf). assert (L3 := Rmult_le_compat_l (e * (rho_1 + rho_2)) _ _ eq (proj2 r0)).
    unfold lost, normal_loses. lra. }
  assert (hW : h * W = h * x a_z + h * F) by (unfold W; ring). assert (hf_is : W * (h * f) = h * W * r + h * (W * p)) by (unfold f; ring).
  assert (ha : h * x a_z <= / 85070591730234615865843651857942052864 * x a_z) by (apply Rmult_le_compat_r; lra).
  assert (ha0 := Rmult_le_pos h _ ltac:(lra) a_z_in). assert (hFe := Rmult_le_compat_l h _ _ ltac:(lra) Fe).
  assert (hF0 := Rmult_le_pos h F ltac:(lra) ltac:(lra)).
  assert (Wr := Rmult_le_compat_l (h * W) _ _ ltac:(lra) (proj2 r0)). assert (Wp := Rmult_le_compat_l h _ _ ltac:(lra) position_in).
  assert (WG0 := Rmult_le_pos W G W0 ltac:(lra)).
  assert (Whf : W * (h * f) <= / 100000 * (A + R1)) by lra.
  assert (WG2 := Rmult_le_compat_l W _ _ W0 G2). assert (Wl := Rmult_le_compat_l W _ _ W0 lf2).
  assert (AW : A_w <= W) by (assert (K := between _ _ a_w_near); unfold W; lra).
  assert (N_moves := Rmult_le_compat _ _ _ _ A_w0 (Rabs_pos _) AW Q_near). rewrite <- (Rabs_pos_eq A_w) in N_moves at 1 by exact A_w0.
  rewrite <- Rabs_mult in N_moves.
  (* What a moves, and the roundings. *)
  assert (b1 := Rabs_pos (x N_x)). assert (b2 := Rabs_pos (x N_y)). assert (b3 := Rabs_pos (x N_w)).
  assert (c1 := Rabs_pos (x a_x)). assert (c2 := Rabs_pos (x a_y)). assert (c3 := Rabs_pos (x a_z)).
  assert (d1 := Rabs_pos (x N_x * x a_x)). assert (d2 := Rabs_pos (x N_y * x a_y)). assert (d3 := Rabs_pos (x N_w * x a_z)).
  assert (t2 := Rabs_triang (t' - x N_w * x a_z) (x N_w * x a_z)). replace (t' - x N_w * x a_z + x N_w * x a_z) with t' in t2 by ring.
  assert (t1 := Rabs_triang (t - (x N_y * x a_y + t')) (x N_y * x a_y + t')).
  replace (t - (x N_y * x a_y + t') + (x N_y * x a_y + t')) with t in t1 by ring.
  assert (t3 := Rabs_triang (x N_y * x a_y) t'). assert (t4 := Rabs_triang (x N_x * x a_x) t).
  assert (L1 := Rmult_le_compat_l _ _ _ b1 a_x_near). assert (L2 := Rmult_le_compat_l _ _ _ b2 a_y_near).
  assert (L3 := Rmult_le_compat_l _ _ _ b3 a_w_near). rewrite <- !Rabs_mult in L1, L2, L3.
  assert (hn1 := Rmult_le_compat_l _ _ _ b1 hE). assert (hn2 := Rmult_le_compat_l _ _ _ b2 hE). assert (hn3 := Rmult_le_compat_l _ _ _ b3 hF).
  assert (hb1 := Rmult_le_pos _ h b1 ltac:(lra)). assert (hb2 := Rmult_le_pos _ h b2 ltac:(lra)). assert (hb3 := Rmult_le_pos _ h b3 ltac:(lra)).
  assert (ha1 := Rmult_le_compat_r _ _ _ c1 (proj2 h0)). assert (ha2 := Rmult_le_compat_r _ _ _ c2 (proj2 h0)). assert (ha3 := Rmult_le_compat_r _ _ _ c3 (proj2 h0)).
  assert (hc1 := Rmult_le_pos h _ ltac:(lra) c1). assert (hc2 := Rmult_le_pos h _ ltac:(lra) c2). assert (hc3 := Rmult_le_pos h _ ltac:(lra) c3).
  assert (R := proj1 (R1_is x E_in F_in)). fold R1 in R. fold E F in R.
  assert (T : Rabs (v - (x N_x * x a_x + t)) + Rabs (t - (x N_y * x a_y + t')) + Rabs (t' - x N_w * x a_z) <=
    302 / 100 * (/ 16777216) * (Rabs (x N_x * x a_x) + Rabs (x N_y * x a_y) + Rabs (x N_w * x a_z)) +
    3 * h * (Rabs (x N_x) + Rabs (x N_y) + Rabs (x N_w) + Rabs (x a_x) + Rabs (x a_y) + Rabs (x a_z) + 5)).
  { clear - T1 T2 T3 t1 t2 t3 t4 h0 b1 b2 b3 c1 c2 c3 d1 d2 d3 hb1 hb2 hb3 hc1 hc2 hc3. lra. }
  assert (v1 := between _ _ (Rle_refl (Rabs (v - (x N_x * x a_x + t))))).
  assert (v2 := between _ _ (Rle_refl (Rabs (t - (x N_y * x a_y + t'))))).
  assert (v3 := between _ _ (Rle_refl (Rabs (t' - x N_w * x a_z)))).
  replace ((Y1 * W2 - W1 * Y2) * A_x + (W1 * X2 - X1 * W2) * A_y + (X1 * Y2 - Y1 * X2) * A_w - v) with
    (A_w * (Q - (x N_x * P_x + x N_y * P_y + x N_w)) + (x N_x * (A_x - x a_x) + x N_y * (A_y - x a_y) + x N_w * (A_w - x a_z)) -
     ((v - (x N_x * x a_x + t)) + (t - (x N_y * x a_y + t')) + (t' - x N_w * x a_z))) by (unfold Q; rewrite A_x_is, A_y_is; ring).
  apply between in N_moves, L1, L2, L3. apply Rabs_le.
  clear - N_moves L1 L2 L3 T v1 v2 v3 Wl WG2 Whf A_is R hn1 hn2 hn3 ha1 ha2 ha3 R0 R2 h0 b1 b2 b3 c1 c2 c3 d1 d2 d3 hb1 hb2 hb3 hc1 hc2 hc3.
  simpl. lra.
Qed.
End Moved.
End InGrid.

(* What the margin multiplies with 1.01 has only positive terms, so that it is computed at least at this much of its size; its
   quotients have met 5 roundings more. *)
Lemma inflation_is_enough : Qle_bool of_quotient (inflation * (1 - alphaQ u32Q (roundings margin + 5))) = true.
Proof. vm_compute. reflexivity. Qed.

Definition constants := Eval vm_compute in shown least_bound of_largest.
Print constants.
Definition checked := (rounding, of_quotients, margin_near, products_near, delta_np_has_it, determinant_is,
  determinant_moves, quotients_are, over_least, under_most, quotients_are_enough, np_has_it, det_has_it, delta_parts, delta_is,
  anywhere_least, cross_moves, quotient_moves, in_grid_is, position_has_it, in_grid_least,
  in_grid_moves, inflation_is_enough, kernel_is_enough).
Print Assumptions checked.
