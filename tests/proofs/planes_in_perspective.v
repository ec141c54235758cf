(* SPDX-License-Identifier: MIT *)
(* triangle_records.clh, set_plane_perspective(): how far 1 / W of a plane at a point of the grid may be from the real
  one
   (docs/numerics.md, 4). Four theorems:
     rounding         the computed height, from the record's numbers: 8 u L;
     products_near    N . p from the rounded N: delta_np's term of products;
     cross_moves      N . p: delta_np's other terms, from the errors of two sides;
     quotient_moves   what the errors of N . p and det do to their quotient.

   Assumed: |X|, |Y| <= reach; a quotient is off by 2.5 ulp; no result is below 2^-126 unless it is 0 (UNDERFLOW
     covers it:
   prose). In prose: the roundings of N . a, where the triangle straddles the light as here and where it does not; the
     point's
   height, 2 L height_error. The 1 % covers the margin's own roundings (planes.v). Overflow: no height is certain
     where the margin is infinite. *)
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
  Add (Add (Times (1 # 4194304) (Add (Add (Abs (Mul (Diff b_x a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff
    c_x a_x)))) (Add (Mul (Add (Abs (Mul (Diff b_x a_x) (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_x a_x))))
    (Add (Given point_error 0) (Given side 0))) (Mul (Add (Abs (Mul (Diff b_y a_y) (Diff c_z a_z))) (Abs (Mul (Diff
    b_z a_z) (Diff c_y a_y)))) (Add (Given point_error 0) (Given side 0)))))) (Times (2 # 1) (Add (Add (Mul (Add
    (Add (Add (Given error 0) (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0))) (Given error 0))
    (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0))) (Add (Given greater_3 0) (Mul (Abs (Diff b_z
    a_z)) (Given point_error 0)))) (Mul (Add (Add (Add (Given error 0) (Mul (Add (Given point_error 0) (Given side
    0)) (Given error_w 0))) (Given error 0)) (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0)))
    (Add (Given greater_6 0) (Mul (Abs (Diff c_z a_z)) (Given point_error 0))))) (Mul (Add (Add (Add (Given error 0)
    (Mul (Add (Given point_error 0) (Given side 0)) (Given error_w 0))) (Given error 0)) (Mul (Add (Given
    point_error 0) (Given side 0)) (Given error_w 0))) (Add (Add (Add (Given error 0) (Mul (Add (Given point_error
    0) (Given side 0)) (Given error_w 0))) (Given error 0)) (Mul (Add (Given point_error 0) (Given side 0)) (Given
    error_w 0))))))) (Mul (Add (Abs (Given quotient_3 5)) (Add (Mul (Abs (Given quotient_1 5)) (Add (Given
    point_error 0) (Given side 0))) (Mul (Abs (Given quotient_2 5)) (Add (Given point_error 0) (Given side 0)))))
    (Add (Add (Add (Add (Add (Mul (Abs quotient_1_over) (Given error 0)) (Mul (Abs quotient_2_over) (Given error
    0))) (Mul (Abs quotient_3_over) (Given error_w 0))) (Times (1 # 4194304) (Add (Abs (Mul quotient_3_over (Given
    a_z 0))) (Add (Abs (Mul quotient_1_over (Given a_x 0))) (Abs (Mul quotient_2_over (Given a_y 0))))))) (Times
    (11150373 # 11150372599265311570767859136324180752990208) (Add (Add (Abs (Given a_z 0)) (Add (Abs (Given a_x 0))
    (Abs (Given a_y 0)))) (Const (1 # 1))))) (Add (Mul (Add (Add (Abs (Given a_z 0)) (Given error_w 0)) (Add (Add
    (Abs (Given a_x 0)) (Given error 0)) (Add (Abs (Given a_y 0)) (Given error 0)))) (Add (Add (Mul (Add (Abs (Diff
    b_z a_z)) (Add (Abs (Diff b_x a_x)) (Abs (Diff b_y a_y)))) (Add (Add (Add (Given error 0) (Given error 0))
    (Given error_w 0)) (Given error_w 0))) (Mul (Add (Abs (Diff c_z a_z)) (Add (Abs (Diff c_x a_x)) (Abs (Diff c_y
    a_y)))) (Add (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0)))) (Mul (Add (Add
    (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0)) (Add (Add (Add (Given error 0)
    (Given error 0)) (Given error_w 0)) (Given error_w 0))))) (Times (1 # 4194304) (Add (Add (Mul (Add (Abs (Given
    a_x 0)) (Given error 0)) (Add (Abs (Mul (Diff b_y a_y) (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_y
    a_y))))) (Mul (Add (Abs (Given a_y 0)) (Given error 0)) (Add (Abs (Mul (Diff b_x a_x) (Diff c_z a_z))) (Abs (Mul
    (Diff b_z a_z) (Diff c_x a_x)))))) (Mul (Add (Abs (Given a_z 0)) (Given error_w 0)) (Add (Abs (Mul (Diff b_x
    a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x)))))))))).
Definition quotient_4_under :=
  Sub (Abs quotient_3_under) (Times (4236247 # 4194304) (Add (Add (Add (Add (Add (Mul (Abs quotient_1_over) (Given
    error 0)) (Mul (Abs quotient_2_over) (Given error 0))) (Mul (Abs quotient_3_over) (Given error_w 0))) (Times (1
    # 4194304) (Add (Abs (Mul quotient_3_over (Given a_z 0))) (Add (Abs (Mul quotient_1_over (Given a_x 0))) (Abs
    (Mul quotient_2_over (Given a_y 0))))))) (Times (11150373 # 11150372599265311570767859136324180752990208) (Add
    (Add (Abs (Given a_z 0)) (Add (Abs (Given a_x 0)) (Abs (Given a_y 0)))) (Const (1 # 1))))) (Add (Mul (Add (Add
    (Abs (Given a_z 0)) (Given error_w 0)) (Add (Add (Abs (Given a_x 0)) (Given error 0)) (Add (Abs (Given a_y 0))
    (Given error 0)))) (Add (Add (Mul (Add (Abs (Diff b_z a_z)) (Add (Abs (Diff b_x a_x)) (Abs (Diff b_y a_y))))
    (Add (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0))) (Mul (Add (Abs (Diff c_z
    a_z)) (Add (Abs (Diff c_x a_x)) (Abs (Diff c_y a_y)))) (Add (Add (Add (Given error 0) (Given error 0)) (Given
    error_w 0)) (Given error_w 0)))) (Mul (Add (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given
    error_w 0)) (Add (Add (Add (Given error 0) (Given error 0)) (Given error_w 0)) (Given error_w 0))))) (Times (1 #
    4194304) (Add (Add (Mul (Add (Abs (Given a_x 0)) (Given error 0)) (Add (Abs (Mul (Diff b_y a_y) (Diff c_z a_z)))
    (Abs (Mul (Diff b_z a_z) (Diff c_y a_y))))) (Mul (Add (Abs (Given a_y 0)) (Given error 0)) (Add (Abs (Mul (Diff
    b_x a_x) (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_x a_x)))))) (Mul (Add (Abs (Given a_z 0)) (Given
    error_w 0)) (Add (Abs (Mul (Diff b_x a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x)))))))))).
Definition quotient_5_over :=
  Add (Abs quotient_1_over) (Abs quotient_2_over).
Definition quotient_5_under :=
  quotient_4_under.
(* margin: where mul(add(add(add(quotient_4, mul(quotient_5, point_error)), mul(add(abs(quotient_3),
   add(mul(abs(quotient_1), add(point_error, side)), mul(abs(quotient_2), add(point_error, side)))),
   4.76837158203125e-07)), mul(add(abs(quotient_3), add(mul(abs(quotient_1), add(point_error, side)),
   mul(abs(quotient_2), add(point_error, side)))), mul(2.0, height_error))), 1.0099999904632568) <
   mul(add(abs(quotient_3), add(mul(abs(quotient_1), add(point_error, side)), mul(abs(quotient_2), add(point_error,
   side)))), 0.5) *)
(* margin: where mul(quotient_3_under, orientation) > 0.0 *)
(* margin: where quotient_5_under > mul(abs(quotient_3_under), 0.25) *)
Definition margin :=
  Times (4236247 # 4194304) (Add (Add (Add (Given quotient_4 5) (Mul (Given quotient_5 5) (Given point_error 0)))
    (Times (1 # 2097152) (Add (Abs (Given quotient_3 5)) (Add (Mul (Abs (Given quotient_1 5)) (Add (Given
    point_error 0) (Given side 0))) (Mul (Abs (Given quotient_2 5)) (Add (Given point_error 0) (Given side 0)))))))
    (Mul (Add (Abs (Given quotient_3 5)) (Add (Mul (Abs (Given quotient_1 5)) (Add (Given point_error 0) (Given side
    0))) (Mul (Abs (Given quotient_2 5)) (Add (Given point_error 0) (Given side 0))))) (Times (2 # 1) (Given
    height_error 0)))).
(* where mul(quotient_3_under, orientation) > 0.0 *)
(* where quotient_5_under > mul(abs(quotient_3_under), 0.25) *)
(* where margin < mul(add(abs(quotient_3), add(mul(abs(quotient_1), add(point_error, side)), mul(abs(quotient_2),
   add(point_error, side)))), 0.5) *)
(* end: from the kernels *)

Section Plane.
Variable x : nat -> R.
Open Scope R_scope.

(* ---- The height's roundings ---- *)
Let reach := x point_error + x side.
Hypotheses (X_in : Rabs (x X) <= reach) (Y_in : Rabs (x Y) <= reach).
Hypotheses (side_positive : 0 <= x side) (error_positive : 0 <= x point_error).

(* L: the sum of the magnitudes that the margin multiplies with its constant. *)
Definition of_largest := match margin with Times _ (Add (Add _ (Times c _)) _) => c | _ => 0%Q end.
Definition largest := match margin with Times _ (Add (Add _ (Times _ l)) _) => l | _ => Const 0 end.
Definition inflation := match margin with Times i _ => i | _ => 0%Q end.
Lemma margin_is : margin = Times inflation
  (Add (Add (Add (Given quotient_4 5) (Mul (Given quotient_5 5) (Given point_error 0))) (Times of_largest largest))
       (Mul largest (Times 2 (Given height_error 0)))).
Proof. reflexivity. Qed.
(* The margin rounds four times more than `largest`. *)
Definition constant : Q := of_largest * inflation * (1 - (5 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (rate u32Q height largest / (inflation * (1 - (5 # 2 ^ 24))))%Q.

Lemma products : permanent x height <= permanent x largest.
Proof.
  assert (P := Rabs_pos_eq _ error_positive). assert (S := Rabs_pos_eq _ side_positive).
  cbv [height largest margin permanent]. rewrite P, S.
  assert (G1 := Rmult_le_compat_r _ _ _ (Rabs_pos (x quotient_1)) X_in).
  assert (G2 := Rmult_le_compat_r _ _ _ (Rabs_pos (x quotient_2)) Y_in). unfold reach in *. lra.
Qed.

Theorem rounding v s :
  within_limits x (Q2R any) (Q2R any) height -> within_limits x (Q2R any) (Q2R any) largest ->
  computes_normal x height v -> computes_normal x largest s -> 0 <= s -> Rabs (v - real x height) <= Q2R constant * s.
Proof.
  assert (P := Rabs_pos_eq _ error_positive). assert (S := Rabs_pos_eq _ side_positive).
  intros. eapply float_error_of_normal_numbers with (size := largest) (m := fun _ => any) (d := fun _ _ => any); try
    eassumption.
  - vm_compute. reflexivity.
  - apply products.
  - cbv [largest margin real permanent]. rewrite P, S. reflexivity.
Qed.

(* ---- N . p: delta_np's second term ---- *)
Definition of_products := match quotient_4_over with Add (Add (Times c _) _) _ => c | _ => 0%Q end.
Definition sizes := match quotient_4_over with Add (Add (Times _ s) _) _ => s | _ => Const 0 end.
Theorem products_near n_x n_y n_w :
  computes_normal x quotient_1_over n_x -> within_limits x (Q2R any) (Q2R any) quotient_1_over ->
  computes_normal x quotient_2_over n_y -> within_limits x (Q2R any) (Q2R any) quotient_2_over ->
  computes_normal x quotient_3_over n_w -> within_limits x (Q2R any) (Q2R any) quotient_3_over ->
  Rabs ((n_x * x X + n_y * x Y + n_w) -
        (real x quotient_1_over * x X + real x quotient_2_over * x Y + real x quotient_3_over)) <=
  (1 + / 1048576) * Q2R of_products * real x sizes.
Proof.
  intros C1 L1 C2 L2 C3 L3.
  assert (near : forall e v, roundings e = 4%nat -> computes_normal x e v -> within_limits x (Q2R any) (Q2R any) e ->
    Rabs (v - real x e) <= (1 + / 1048576) * / 4194304 * permanent x e).
  { intros e v He C L. assert (N := error_of_normal_numbers x (fun _ => any) (fun _ _ => any) e v L C). rewrite He in N.
    assert (G := Rmult_le_compat_r _ _ _ (permanent_positive x e) four_roundings). lra. }
  assert (N1 := near quotient_1_over _ eq_refl C1 L1). assert (N2 := near quotient_2_over _ eq_refl C2 L2). assert (N3
    := near quotient_3_over _ eq_refl C3 L3).
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
End Plane.

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

Definition constants := Eval vm_compute in shown least_bound of_largest.
Print constants.
Definition checked := (rounding, products_near, cross_moves, quotient_moves).
Print Assumptions checked.
