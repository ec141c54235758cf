(* SPDX-License-Identifier: MIT *)
(* parallel_packets.clh: h of a triangle that a ray's line meets, the sum of e_k (height of corner k - height of P),
   against PACKET_BOUND_OF_HEIGHT m (S + |P_w|), m = u (S + q) (77 S + 10.4 R) of packets.v (docs/numerics.md, 16).
     rounding_near   h from the computed coordinates: u S^2 (48.2 q + 64.4 |P_w| + 48.5 S);
     height_near     with the errors of the e and of the heights;
     corner_is_behind   a corner that is computed to be below P by PACKET_BOUND_OF_CORNER (S + R) is below it.

   Assumed: computed coordinates of corners are at most 1.001 S in size, and their heights off by 4.02 u S, P's by
   4.02 u R; each e is off by the error in packets.v, 18.2 u (S + q) S + 9.9 u (S + q) R; the line meets the
   triangle, so that the real e have one sign, here positive, and add up to twice the area, at most 4.02 S^2; no
   input exceeds 2^22. Denormals may be kept or flushed: heights are off by 2^-97 more, and each e by 2^-65, half of
   BEAM_UNDERFLOW (packets.v). Overflow: coordinates are at most 2^19. *)
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
Definition p_x := 9%nat.
Definition p_y := 10%nat.
Definition p_z := 11%nat.
Definition area :=
  Fma (Diff b_x a_x) (Diff c_y a_y) (Mul (Neg (Diff a_x c_x)) (Diff a_y b_y)).
Definition height :=
  Fma (Fma (Given a_z 0) (Diff b_y c_y) (Fma (Given b_z 0) (Diff c_y a_y) (Mul (Given c_z 0) (Diff a_y b_y))))
    (Given p_x 0) (Fma (Fma (Given a_z 0) (Diff c_x b_x) (Fma (Given b_z 0) (Diff a_x c_x) (Mul (Given c_z 0) (Diff
    b_x a_x)))) (Given p_y 0) (Fma (Given p_z 0) (Neg (Abs area)) (Fma (Fma (Given b_x 0) (Given c_y 0) (Mul (Given
    c_x 0) (Neg (Given b_y 0)))) (Given a_z 0) (Fma (Fma (Given a_y 0) (Given c_x 0) (Mul (Given a_x 0) (Neg (Given
    c_y 0)))) (Given b_z 0) (Mul (Fma (Given a_x 0) (Given b_y 0) (Mul (Given b_x 0) (Neg (Given a_y 0)))) (Given
    c_z 0)))))).
Definition factor :=
  Const (8 # 1).
Definition of_corner :=
  Const (8796093 # 17592186044416).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation computed := (limited32 (2 ^ 22)).
Local Notation z := (/ 158456325028528675187087900672).  (* 2^-97 *)
Local Notation r := (/ 36893488147419103232).  (* 2^-65 *)
Definition rest : Q := 1 # 1180591620717411303424.  (* 2^-70 *)
Lemma rest_is : Q2R rest = / 1180591620717411303424.
Proof. unfold Q2R, rest; simpl; lra. Qed.

Section Height.
Variable x : nat -> R.
Variables S R' : R.
Hypotheses (S0 : 0 <= S) (R0 : 0 <= R') (S_in : S <= 16777216).
Let q := Rabs (x p_x) + Rabs (x p_y).
Let p := Rabs (x p_z).
Let near_corner i := Rabs (x i) <= 1001 / 1000 * S.
Hypotheses (a_x_in : near_corner a_x) (a_y_in : near_corner a_y) (a_z_in : near_corner a_z).
Hypotheses (b_x_in : near_corner b_x) (b_y_in : near_corner b_y) (b_z_in : near_corner b_z).
Hypotheses (c_x_in : near_corner c_x) (c_y_in : near_corner c_y) (c_z_in : near_corner c_z).

(* e of the computed coordinates, in real numbers; twice the area. *)
Let e i_x i_y j_x j_y := (x i_x - x p_x) * (x j_y - x p_y) - (x i_y - x p_y) * (x j_x - x p_x).
Let e_a := e b_x b_y c_x c_y. Let e_b := e c_x c_y a_x a_y. Let e_c := e a_x a_y b_x b_y.
Definition real_height := e_a * (x a_z - x p_z) + e_b * (x b_z - x p_z) + e_c * (x c_z - x p_z).
Hypothesis area0 : 0 <= real x area.
Lemma height_is : real x height = real_height.
Proof.
  unfold height. cbn [real]. rewrite (Rabs_pos_eq (real x area)) by exact area0.
  unfold real_height, e_a, e_b, e_c, e, area. cbn [real]. ring.
Qed.

Lemma pair i j m n : Rabs (x i) <= m -> Rabs (x j) <= n -> Rabs (x i) * Rabs (x j) <= m * n.
Proof. intros. apply Rmult_le_compat; auto using Rabs_pos. Qed.
Lemma apart i j : near_corner i -> near_corner j -> Rabs (x i - x j) <= 2002 / 1000 * S.
Proof. unfold near_corner. intros. apply between in H. apply between in H0. apply Rabs_le. lra. Qed.
Lemma times_apart i j k : near_corner i -> near_corner j -> near_corner k -> Rabs (x i) * Rabs (x j - x k) <= 2005 /
  1000
  * (S * S).
Proof.
  intros Hi Hj Hk. assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Hi (apart _ _ Hj Hk)).
  assert (SS : 0 <= S * S) by (apply Rmult_le_pos; auto). lra.
Qed.
Lemma both_apart i j k l : near_corner i -> near_corner j -> near_corner k -> near_corner l ->
  Rabs (x i - x j) * Rabs (x k - x l) <= 4009 / 1000 * (S * S).
Proof.
  intros Hi Hj Hk Hl. assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) (apart _ _ Hi Hj) (apart _ _ Hk
    Hl)).
  assert (SS : 0 <= S * S) by (apply Rmult_le_pos; auto). lra.
Qed.
Lemma three i j k : near_corner i -> near_corner j -> near_corner k -> Rabs (x i) * Rabs (x j) * Rabs (x k) <= 1004 /
  1000 * (S * S * S).
Proof.
  unfold near_corner. intros Hi Hj Hk. assert (G := pair _ _ _ _ Hi Hj).
  assert (H := Rmult_le_compat _ _ _ _ (Rmult_le_pos _ _ (Rabs_pos _) (Rabs_pos _)) (Rabs_pos _) G Hk).
  assert (SS : 0 <= S * S * S) by (repeat apply Rmult_le_pos; auto). lra.
Qed.

Definition of_rounding := u * (S * S * (482 / 10 * q + 644 / 10 * p + 485 / 10 * S)) + Q2R rest.
Theorem rounding_near v : computed x height v -> Rabs (v - real_height) <= of_rounding.
Proof.
  intros C. assert (N := near_limited (2 ^ 22) rest x height v ltac:(vm_compute; reflexivity) C). clear C. rewrite
    height_is in N.
  eapply Rle_trans; [exact N | clear N].
  assert (A := alpha_below 8 ltac:(lia)). simpl INR in A. change (roundings height) with 8%nat.
  assert (T1 := times_apart _ _ _ a_z_in b_y_in c_y_in). assert (T2 := times_apart _ _ _ b_z_in c_y_in a_y_in).
  assert (T3 := times_apart _ _ _ c_z_in a_y_in b_y_in). assert (T4 := times_apart _ _ _ a_z_in c_x_in b_x_in).
  assert (T5 := times_apart _ _ _ b_z_in a_x_in c_x_in). assert (T6 := times_apart _ _ _ c_z_in b_x_in a_x_in).
  assert (B1 := both_apart _ _ _ _ b_x_in a_x_in c_y_in a_y_in).
  assert (B2 := both_apart _ _ _ _ a_x_in c_x_in a_y_in b_y_in).
  assert (U1 := three _ _ _ b_x_in c_y_in a_z_in). assert (U2 := three _ _ _ c_x_in b_y_in a_z_in).
  assert (U3 := three _ _ _ a_y_in c_x_in b_z_in). assert (U4 := three _ _ _ a_x_in c_y_in b_z_in).
  assert (U5 := three _ _ _ a_x_in b_y_in c_z_in). assert (U6 := three _ _ _ b_x_in a_y_in c_z_in).
  assert (sum : forall l m n b, l <= b -> m <= b -> n <= b -> l + (m + n) <= 3 * b) by (intros; lra).
  assert (V1 := Rmult_le_compat_r _ _ _ (Rabs_pos (x p_x)) (sum _ _ _ _ T1 T2 T3)).
  assert (V2 := Rmult_le_compat_r _ _ _ (Rabs_pos (x p_y)) (sum _ _ _ _ T4 T5 T6)).
  assert (V3 := Rmult_le_compat_l p _ _ (Rabs_pos _) (Rplus_le_compat _ _ _ _ B1 B2)).
  assert (SS : 0 <= S * S) by (apply Rmult_le_pos; auto).
  assert (Sx := Rmult_le_pos _ _ SS (Rabs_pos (x p_x))). assert (Sy := Rmult_le_pos _ _ SS (Rabs_pos (x p_y))).
  assert (Sz := Rmult_le_pos _ _ SS (Rabs_pos (x p_z))). assert (SSS := Rmult_le_pos _ _ SS S0).
  assert (P : permanent x height <= S * S * (6016 / 1000 * q + 8019 / 1000 * p + 6025 / 1000 * S)).
  { unfold height, area. cbn [permanent]. unfold p, q in *. lra. }
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 8) (permanent_positive x height) A P).
  unfold of_rounding, p, q in *. lra.
Qed.

(* The real numbers: e, the corners' heights, and P's. *)
Variables E_a E_b E_c A_w B_w C_w P_w : R.
Hypotheses (E_a0 : 0 <= E_a) (E_b0 : 0 <= E_b) (E_c0 : 0 <= E_c) (area_in : E_a + E_b + E_c <= 402 / 100 * (S * S)).
Definition of_e := u * ((S + q) * (182 / 10 * S + 99 / 10 * R')) + r.
Hypotheses (e_a_near : Rabs (e_a - E_a) <= of_e) (e_b_near : Rabs (e_b - E_b) <= of_e) (e_c_near : Rabs (e_c - E_c) <=
  of_e).
Let near_height i w s := Rabs (x i - w) <= 402 / 100 * u * s + z.
Hypotheses (a_w_near : near_height a_z A_w S) (b_w_near : near_height b_z B_w S) (c_w_near : near_height c_z C_w S).
Hypothesis p_w_near : near_height p_z P_w R'.
Definition m := u * ((S + q) * (772 / 10 * S + 104 / 10 * R')) + r.
Definition least_factor : Q := 442 # 100.

Lemma term_near f F i w : near_corner i -> Rabs (f - F) <= of_e -> 0 <= F -> near_height i w S ->
  Rabs (f * (x i - x p_z) - F * (w - P_w)) <= of_e * (1001 / 1000 * S + p) + F * (402 / 100 * u * (S + R') + 2 * z).
Proof.
  intros Hi Hf F0 Hw. replace (f * (x i - x p_z) - F * (w - P_w)) with ((f - F) * (x i - x p_z) + F * ((x i - w) + - (x
    p_z - P_w))) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult, (Rabs_pos_eq F) by assumption.
  assert (D : Rabs (x i - x p_z) <= 1001 / 1000 * S + p).
  { unfold Rminus. eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp. unfold near_corner, p in *. lra. }
  assert (H : Rabs (x i - w + - (x p_z - P_w)) <= 402 / 100 * u * (S + R') + 2 * z).
  { eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp. unfold near_height in *. lra. }
  assert (G1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Hf D). assert (G2 := Rmult_le_compat_l _ _ _ F0 H).
    lra.
Qed.

Theorem height_near v : computed x height v ->
  Rabs (v - (E_a * (A_w - P_w) + E_b * (B_w - P_w) + E_c * (C_w - P_w))) <= Q2R least_factor * (m * (S + p)) + Q2R rest.
Proof.
  intros C. assert (N := rounding_near _ C). assert (q0 : 0 <= q) by (apply Rplus_le_le_0_compat; apply Rabs_pos).
  assert (p0 : 0 <= p) by apply Rabs_pos.
  assert (T1 := term_near _ _ _ _ a_z_in e_a_near E_a0 a_w_near).
  assert (T2 := term_near _ _ _ _ b_z_in e_b_near E_b0 b_w_near).
  assert (T3 := term_near _ _ _ _ c_z_in e_c_near E_c0 c_w_near).
  assert (D0 : 0 <= 402 / 100 * u * (S + R') + 2 * z) by lra.
  assert (G := Rmult_le_compat_r _ _ _ D0 area_in).
  replace (Q2R least_factor) with (442 / 100) by (unfold Q2R, least_factor; simpl; lra).
  assert (P := fun s t r a b c => Rmult_le_pos (s * t) r (Rmult_le_pos s t a b) c).
  assert (M1 := P _ _ _ S0 S0 S0). assert (M2 := P _ _ _ S0 S0 q0). assert (M3 := P _ _ _ S0 S0 p0).
  assert (M4 := P _ _ _ S0 S0 R0).
  assert (M5 := P _ _ _ S0 q0 p0). assert (M6 := P _ _ _ S0 R0 p0). assert (M7 := P _ _ _ S0 q0 R0).
  assert (M8 := P _ _ _ q0 R0 p0).
  assert (SS := Rmult_le_compat_l _ _ _ S0 S_in).
  unfold of_rounding, real_height, m, of_e in *. rewrite rest_is in *. apply between in N, T1, T2, T3. apply Rabs_le.
    lra.
Qed.
End Height.

(* g and w are computed heights, l what w is lowered by, c (S + R) + 2^-64 with 5 roundings, and t the difference. *)
Definition least_corner : Q := 52 # 167772160.
Theorem corner_is_behind c S R' g G w W l t : 0 <= S -> 0 <= R' -> Rabs (g - G) <= 402 / 100 * u * S + z ->
  Rabs (w - W) <= 402 / 100 * u * R' + z -> Rabs w <= 1001 / 1000 * R' -> Q2R least_corner <= Q2R c <= 100 * u ->
  Rabs (l - (Q2R c * (S + R') + 2 * r)) <= 6 * u * (Q2R c * (S + R') + 2 * r) ->
  Rabs (t - (w - l)) <= u * Rabs (w - l) + 4 * h32 -> g < t -> G < W.
Proof.
  intros S0 R0 Hg Hw w_in Hc Hl Ht H. replace (Q2R least_corner) with (52 / 10 * u) in Hc by (unfold Q2R, least_corner;
    simpl; lra).
  assert (B := Rmult_le_compat_r (S + R') _ _ ltac:(lra) (proj1 Hc)). assert (h := h32_below). simpl in h.
  assert (B' := Rmult_le_compat_r (S + R') _ _ ltac:(lra) (proj2 Hc)).
  apply between in Hg, Hw, w_in, Hl. assert (D : Rabs (w - l) <= 1002 / 1000 * (S + R') + 3 * r) by (apply Rabs_le;
    lra).
  apply (at_most32 _ _ _ _ Ht) in D. apply between in D. lra.
Qed.

Definition kernels_corner : Q := match of_corner with Const c => c | _ => 0%Q end.
Definition kernels_factor : Q := match factor with Const c => c | _ => 0%Q end.
Lemma kernel_is_enough : (least_factor <= kernels_factor * (1 - alphaQ u32Q 8) /\ least_corner <= kernels_corner)%Q.
Proof. vm_compute. split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_factor kernels_factor.
Print constants.
Definition rests := Eval vm_compute in shown least_corner kernels_corner.
Print rests.
Definition checked := (rounding_near, height_near, corner_is_behind, kernel_is_enough).
Print Assumptions checked.
