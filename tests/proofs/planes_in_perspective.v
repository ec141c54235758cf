(* SPDX-License-Identifier: MIT *)
(* triangle_records.clh, set_plane_perspective(): how far 1 / W of a plane at a point of the grid may be from the real one
   (docs/numerics.md, 4):
     rounding, of_quotients  the computed height, from the record's numbers: 8 u L, and 2^-99;
     margin_near             the margin, from its quotients;
     products_near           N . p from the rounded N: delta_np's term of products; delta_np_has_it: what underflow takes;
     determinant_moves       N . a, where a lies anywhere: delta_determinant, with all its roundings;
     cross_moves             N . p: delta_np's other terms, from the errors of two sides;
     quotient_moves          what the errors of N . p and det do to their quotient.

   Assumed: |X|, |Y| <= reach, whose parts are up to 2^16, the rectangle's side from 1 on (a bin has a texel); corners are off by
   `error` and error_w, 2^-90 at least (projection.v); a side is no longer than 4 reach times its rho (edge_functions.v,
   rho_has); a quotient is off by 2.5 ulp and by 2^-126. Denormals may be kept or flushed. In prose: N . a where a lies in the
   grid (its bound has the terms of N . p); what underflow takes of the sums of the margin's quotient, of which each has a term
   with UNDERFLOW, 2^36 times as much; the point's height, 2 L height_error. The 1 % covers the margin's own roundings
   (planes.v). Overflow: no height is certain where the margin is infinite. *)
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
Definition delta := match quotient_4_under with Sub _ (Times _ d) => d | _ => Const 0 end.
Definition determinant := quotient_1_under.
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
Lemma delta_is : real x delta = real_delta (real x quotient_1_over) (real x quotient_2_over) (real x quotient_3_over).
Proof.
  unfold real_delta, D, far_x, far_y, far_w, size_x, size_y, size_w, x1, y1, w1, x2, y2, w2, E, F.
  cbv [delta quotient_4_under]. cbn [real]. rewrite !Rabs_mult.
  replace (Q2R (1 # 4194304)) with (/ 4194304) by (unfold Q2R; simpl; lra).
  replace (Q2R (1 # 1237940039285380274899124224)) with (/ 2 ^ 90) by (unfold Q2R; simpl; lra).
  rewrite Q2R_1, ?Q2R_2. ring.
Qed.

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

Lemma product_moves p q p' q' e f :
  Rabs (p' - p) <= e -> Rabs (q' - q) <= f -> Rabs (p' * q' - p * q) <= Rabs p * f + Rabs q * e + e * f.
Proof.
  intros Hp Hq. replace (p' * q' - p * q) with ((p' - p) * (q' - q) + (p * (q' - q) + q * (p' - p))) by ring.
  assert (T := Rabs_triang ((p' - p) * (q' - q)) (p * (q' - q) + q * (p' - p))).
  assert (U := Rabs_triang (p * (q' - q)) (q * (p' - p))). rewrite !Rabs_mult in *.
  assert (A := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Hp Hq).
  assert (B := Rmult_le_compat_l _ _ _ (Rabs_pos p) Hq). assert (C := Rmult_le_compat_l _ _ _ (Rabs_pos q) Hp). lra.
Qed.
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
Theorem determinant_moves v : computes32 x determinant v -> exists n_x n_y n_w,
  computes32 x quotient_1_over n_x /\ computes32 x quotient_2_over n_y /\ computes32 x quotient_3_over n_w /\
  Rabs ((Y1 * W2 - W1 * Y2) * A_x + (W1 * X2 - X1 * W2) * A_y + (X1 * Y2 - Y1 * X2) * A_w - v) <=
  (1 + / 2 ^ 10) * real_delta n_x n_y n_w.
Proof.
  intros C. destruct (step32_fma _ _ _ _ _ C) as (n_x & a & r & Cx & Ca & C1 & R1). apply given32_is in Ca. subst a.
  destruct (step32_fma _ _ _ _ _ C1) as (n_y & a & r' & Cy & Ca & C2 & R2). apply given32_is in Ca. subst a.
  destruct (step32_mul _ _ _ _ C2) as (n_w & a & Cw & Ca & R3). apply given32_is in Ca. subst a.
  exists n_x, n_y, n_w. repeat split; try assumption.
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

(* What underflow takes of a height, of its quotients and of the margin, and in proportion to L. *)
Lemma kernel_is_enough : (2 * (1 # 2 ^ 100) + (1 # 2 ^ 96) <= of_nothing * (1 - (1 # 2 ^ 20)) /\
  least_bound + (1 # 2 ^ 89) <= of_largest /\ 1 # 2 ^ 90 <= underflow_term)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.

Definition constants := Eval vm_compute in shown least_bound of_largest.
Print constants.
Definition checked := (rounding, of_quotients, margin_near, products_near, delta_np_has_it, delta_is, determinant_moves,
  cross_moves, quotient_moves, kernel_is_enough).
Print Assumptions checked.
