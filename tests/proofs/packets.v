(* SPDX-License-Identifier: MIT *)
(* parallel_packets.clh: e of an edge and twice the area of a triangle in a light's axes, against m = (q + S)
   (PACKET_BOUND_OF_LEAF S + PACKET_BOUND_OF_POINT R): S the leaf's size |X - O|_1, R the point's distance |P -
   O|_1, q = |P_u| + |P_v|.
     coordinates_near   a corner's and a point's coordinates, both at once: 4 u of S or R, whatever they are
        multiplied with;
     e_near, area_near  e is off by u (12 S S + 16 S q + 8 S R), the area by 40 u S S;
     m_is_enough        m is more than both together, and than what follows.

   Assumed: (u, v), the float vectors, are perpendicular and of unit length to 10^-4, so that u_i^2 + v_i^2 <= k^2
   and no vector gets longer than k times its size, computed ones and differences of a computed and a real one
   included; no input exceeds 2^22. Denormals may be kept or flushed: a size here is w, 2^-76, more than the
   kernel's, and m_is_enough has what that and underflow come to in BEAM_UNDERFLOW. In prose (parallel_packets.clh):
   that u and v are not exactly perpendicular to D moves e by 1.75 u (S + R) (S + q); a wrong sign of the area.
   Heights: packet_heights.v. Overflow: coordinates are at most 2^19. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition X_x := 0%nat.
Definition X_y := 1%nat.
Definition X_z := 2%nat.
Definition O_x := 3%nat.
Definition O_y := 4%nat.
Definition O_z := 5%nat.
Definition u_x := 6%nat.
Definition u_y := 7%nat.
Definition u_z := 8%nat.
Definition v_x := 9%nat.
Definition v_y := 10%nat.
Definition v_z := 11%nat.
Definition a_x := 12%nat.
Definition a_y := 13%nat.
Definition b_x := 14%nat.
Definition b_y := 15%nat.
Definition c_x := 16%nat.
Definition c_y := 17%nat.
Definition p_x := 18%nat.
Definition p_y := 19%nat.
Definition leaf := 20%nat.
Definition distance := 21%nat.
Definition off := 22%nat.
Definition coordinate_u :=
  Fma (Given u_x 0) (Diff X_x O_x) (Fma (Given u_y 0) (Diff X_y O_y) (Mul (Given u_z 0) (Diff X_z O_z))).
Definition coordinate_v :=
  Fma (Given v_x 0) (Diff X_x O_x) (Fma (Given v_y 0) (Diff X_y O_y) (Mul (Given v_z 0) (Diff X_z O_z))).
Definition e :=
  Fma (Given p_x 0) (Diff b_y c_y) (Fma (Given p_y 0) (Diff c_x b_x) (Fma (Given b_x 0) (Given c_y 0) (Mul (Given
    c_x 0) (Neg (Given b_y 0))))).
Definition area :=
  Fma (Diff b_x a_x) (Diff c_y a_y) (Mul (Neg (Diff a_x c_x)) (Diff a_y b_y)).
Definition bound :=
  Mul (Add (Times (10115507 # 2199023255552) (Given leaf 0)) (Times (10907155 # 17592186044416) (Given distance 0)))
    (Given off 0).
Definition bound_rest : Q := 1 # 18446744073709551616.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation computed := (limited32 (2 ^ 22)).
Definition rest : Q := 1 # 633825300114114700748351602688.  (* 2^-99 *)
Local Notation rest' := (/ 633825300114114700748351602688).
Local Notation w := (/ 75557863725914323419136).
Lemma rest_is : Q2R rest = rest'.
Proof. unfold Q2R, rest; simpl; lra. Qed.
Tactic Notation "near_in" ident(N) constr(e) :=
  assert (N := near_limited (2 ^ 22) rest _ e _ ltac:(vm_compute; reflexivity) ltac:(eassumption)); rewrite rest_is in
    N; cbn -[u32 alpha] in N.
Local Notation k := (1001 / 1000).
Local Notation four := (401 / 100 * / 16777216).

Lemma four_is : alpha u32 4 <= four.
Proof. assert (F := four_roundings). lra. Qed.

(* Cauchy and Schwarz. *)
Lemma cauchy a b c d r s : 0 <= r -> 0 <= s -> a * a + b * b <= r * r -> c * c + d * d <= s * s ->
  Rabs a * Rabs c + Rabs b * Rabs d <= r * s.
Proof.
  intros r0 s0 H K. assert (A := Rabs_pos a). assert (B := Rabs_pos b). assert (C := Rabs_pos c). assert (D :=
    Rabs_pos d).
  assert (sq : forall y, Rabs y * Rabs y = y * y) by (intros; rewrite <- Rabs_mult; apply Rabs_pos_eq; nra).
  rewrite <- (sq a), <- (sq b) in H. rewrite <- (sq c), <- (sq d) in K. clear sq.
  set (a' := Rabs a) in *. set (b' := Rabs b) in *. set (c' := Rabs c) in *. set (d' := Rabs d) in *. clearbody a' b'
    c' d'.
  apply Rsqr_incr_0_var; [| now apply Rmult_le_pos]. unfold Rsqr.
  assert (L : (a' * c' + b' * d') * (a' * c' + b' * d') <= (a' * a' + b' * b') * (c' * c' + d' * d')).
  { assert (S := Rle_0_sqr (a' * d' - b' * c')). unfold Rsqr in S. lra. }
  assert (M : (a' * a' + b' * b') * (c' * c' + d' * d') <= (r * r) * (s * s)) by (apply Rmult_le_compat; nra). lra.
Qed.

(* ---- Coordinates ---- *)
Section Coordinates.
Variable x : nat -> R.
Let in_frame i j := x i * x i + x j * x j <= k * k.
Hypotheses (frame_x : in_frame u_x v_x) (frame_y : in_frame u_y v_y) (frame_z : in_frame u_z v_z).
Definition size := Rabs (x X_x - x O_x) + Rabs (x X_y - x O_y) + Rabs (x X_z - x O_z).

(* Times s and t, two coordinates of a vector up to r long. *)
Theorem coordinates_near u v s t r :
  computed x coordinate_u u -> computed x coordinate_v v -> 0 <= r -> s * s + t * t <= r * r ->
  Rabs s * Rabs (u - real x coordinate_u) + Rabs t * Rabs (v - real x coordinate_v) <= four * (r * k) * (size + w).
Proof.
  intros Cu Cv r0 st. near_in Nu coordinate_u. near_in Nv coordinate_v. cbv [coordinate_u coordinate_v real].
  set (p := Rabs (x X_x - x O_x)) in *. set (q := Rabs (x X_y - x O_y)) in *. set (y := Rabs (x X_z - x O_z)) in *.
  assert (p0 : 0 <= p) by apply Rabs_pos. assert (q0 : 0 <= q) by apply Rabs_pos. assert (y0 : 0 <= y) by apply
    Rabs_pos.
  assert (C1 := cauchy _ _ _ _ r k r0 ltac:(lra) st frame_x). assert (C2 := cauchy _ _ _ _ r k r0 ltac:(lra) st
    frame_y).
  assert (C3 := cauchy _ _ _ _ r k r0 ltac:(lra) st frame_z).
  assert (D1 := Rmult_le_compat_r p _ _ p0 C1). assert (D2 := Rmult_le_compat_r q _ _ q0 C2).
  assert (D3 := Rmult_le_compat_r y _ _ y0 C3).
  assert (Mu := Rmult_le_compat_l _ _ _ (Rabs_pos s) Nu). assert (Mv := Rmult_le_compat_l _ _ _ (Rabs_pos t) Nv).
  assert (Z : 0 <= alpha u32 4) by (apply alpha_positive; apply bpow_ge_0).
  set (T := Rabs s * (Rabs (x u_x) * p + (Rabs (x u_y) * q + Rabs (x u_z) * y)) +
            Rabs t * (Rabs (x v_x) * p + (Rabs (x v_y) * q + Rabs (x v_z) * y))).
  assert (T1 : T <= r * k * size) by (unfold T, size; fold p q y; lra).
  assert (T0 : 0 <= T).
  { unfold T. apply Rplus_le_le_0_compat; apply Rmult_le_pos; auto using Rabs_pos;
      repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; auto using Rabs_pos. }
  assert (G := Rmult_le_compat _ _ _ _ Z T0 four_is T1).
  assert (s1 : Rabs s <= r) by (apply Rabs_le; nra). assert (t1 : Rabs t <= r) by (apply Rabs_le; nra).
  unfold T in *. lra.
Qed.
End Coordinates.

(* ---- e and the area ---- *)
Section Edge.
Variable x : nat -> R.
(* The sizes, and w. *)
Let S := x leaf + w.
Let R' := x distance + w.
Hypotheses (S0 : 0 <= S) (R0 : 0 <= R').
(* The real coordinates. *)
Variables A_x A_y B_x B_y C_x C_y P_x P_y : R.
(* What coordinates_near says of computed ones. *)
Let near i j X Y size := forall s t r, 0 <= r -> s * s + t * t <= r * r ->
  Rabs s * Rabs (x i - X) + Rabs t * Rabs (x j - Y) <= four * (r * k) * size.
Hypotheses (a_near : near a_x a_y A_x A_y S) (b_near : near b_x b_y B_x B_y S) (c_near : near c_x c_y C_x C_y S).
Hypothesis p_near : near p_x p_y P_x P_y R'.
Let q := Rabs (x p_x) + Rabs (x p_y).
Let long X Y r := X * X + Y * Y <= r * r.
Hypotheses (b_long : long (x b_x) (x b_y) (k * S)) (c_long : long (x c_x) (x c_y) (k * S)) (B_long : long B_x B_y (k *
  S)).
Hypotheses (bc_long : long (x b_y - x c_y) (x c_x - x b_x) (2 * k * S)).
Hypotheses (Bc_long : long (B_x - x c_x) (B_y - x c_y) (2 * k * S)).

Lemma cross_below s t X Y : Rabs (s * Y - t * X) <= Rabs Y * Rabs s + Rabs X * Rabs t.
Proof.
  unfold Rminus. eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, !Rabs_mult. lra.
Qed.
Lemma cross_near i j X Y size s t r : near i j X Y size -> 0 <= r -> long s t r ->
  Rabs ((x i - X) * t - (x j - Y) * s) <= four * (r * k) * size.
Proof.
  intros N r0 L. eapply Rle_trans; [apply cross_below |]. apply N; auto. unfold long in L. lra.
Qed.
(* A vector of any length: |s| + |t| times a coordinate's error. *)
Lemma cross_any i j X Y size s t : 0 <= size -> near i j X Y size ->
  Rabs ((x i - X) * t - (x j - Y) * s) <= four * k * size * (Rabs s + Rabs t).
Proof.
  intros z N. eapply Rle_trans; [apply cross_below |].
  assert (N1 := N 1 0 1 ltac:(lra) ltac:(lra)). assert (N2 := N 0 1 1 ltac:(lra) ltac:(lra)).
  rewrite Rabs_R1, Rabs_R0 in N1, N2.
  assert (M1 : Rabs (x i - X) <= four * (1 * k) * size) by lra. assert (M2 : Rabs (x j - Y) <= four * (1 * k) * size)
    by lra.
  assert (G1 := Rmult_le_compat_l _ _ _ (Rabs_pos t) M1). assert (G2 := Rmult_le_compat_l _ _ _ (Rabs_pos s) M2). lra.
Qed.

Definition of_e := (122 / 10 * (S * S) + 163 / 10 * (S * q) + 81 / 10 * (S * R')) * / 16777216 + rest'.
Theorem e_near v : computed x e v ->
  Rabs (v - ((B_x - P_x) * (C_y - P_y) - (B_y - P_y) * (C_x - P_x))) <= of_e.
Proof.
  intros Cv. near_in N e.
  assert (kS : 0 <= k * S) by lra. assert (kS2 : 0 <= 2 * k * S) by lra.
  assert (D1 := cross_near _ _ _ _ _ (x c_x) (x c_y) _ b_near kS c_long).
  assert (D2 := cross_any _ _ _ _ _ (x p_x) (x p_y) S0 b_near).
  fold q in D2. assert (D3 := cross_near _ _ _ _ _ B_x B_y _ c_near kS B_long). assert (D4 := cross_any _ _ _ _ _ P_x
    P_y S0 c_near).
  assert (D5 := cross_near _ _ _ _ _ (B_x - x c_x) (B_y - x c_y) _ p_near kS2 Bc_long).
  assert (P1 := p_near 1 0 1 ltac:(lra) ltac:(lra)). assert (P2 := p_near 0 1 1 ltac:(lra) ltac:(lra)).
  rewrite Rabs_R1, Rabs_R0 in P1, P2.
  assert (q_real : Rabs P_x + Rabs P_y <= q + 2 * (four * k * R')).
  { unfold q. assert (T1 := Rabs_triang_inv P_x (x p_x)). assert (T2 := Rabs_triang_inv P_y (x p_y)).
    rewrite Rabs_minus_sym in T1, T2. lra. }
  assert (D4' := Rmult_le_compat_l (four * k * S) _ _ ltac:(lra) q_real).
  assert (q0 : 0 <= q) by (unfold q; apply Rplus_le_le_0_compat; apply Rabs_pos).
  assert (R1 : Rabs (x p_x) * Rabs (x b_y - x c_y) + Rabs (x p_y) * Rabs (x c_x - x b_x) <= 2 * k * (S * q)).
  { assert (one : forall s t, long s t (2 * k * S) -> Rabs s <= 2 * k * S /\ Rabs t <= 2 * k * S).
    { unfold long. intros s t H. split; apply Rabs_le; nra. }
    destruct (one _ _ bc_long) as [L1 L2]. unfold q.
    assert (M1 := Rmult_le_compat_l _ _ _ (Rabs_pos (x p_x)) L1). assert (M2 := Rmult_le_compat_l _ _ _ (Rabs_pos (x
      p_y)) L2). lra. }
  assert (c_long' : long (x c_y) (x c_x) (k * S)) by (unfold long in *; lra).
  assert (R2 := cauchy _ _ _ _ _ _ kS kS b_long c_long').
  match type of N with _ <= _ * ?t + _ => set (T := t) in * end.
  assert (T1 : T <= 2 * k * (S * q) + (k * S) * (k * S)) by (unfold T; lra).
  assert (Z : 0 <= alpha u32 4) by (apply alpha_positive; apply bpow_ge_0).
  assert (T0 : 0 <= T) by (unfold T; repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos).
  assert (G := Rmult_le_compat _ _ _ _ Z T0 four_is T1).
  assert (SS : 0 <= S * S) by (apply Rmult_le_pos; lra). assert (SR : 0 <= S * R') by (apply Rmult_le_pos; lra).
  assert (Sq : 0 <= S * q) by (apply Rmult_le_pos; lra).
  apply between in N. apply between in D1. apply between in D2. apply between in D3. apply between in D4.
  apply between in D5. unfold of_e. apply Rabs_le. lra.
Qed.

Hypotheses (ca_long : long (x c_x - x a_x) (x c_y - x a_y) (2 * k * S)).
Hypotheses (ba_long : long (x b_x - x a_x) (x a_y - x b_y) (2 * k * S)) (BA_long : long (B_x - A_x) (B_y - A_y) (2 * k
  * S)).
Definition of_area := 405 / 10 * / 16777216 * (S * S) + rest'.
Theorem area_near v : computed x area v ->
  Rabs (v - ((B_x - A_x) * (C_y - A_y) - (B_y - A_y) * (C_x - A_x))) <= of_area.
Proof.
  intros Cv. near_in N area.
  assert (kS2 : 0 <= 2 * k * S) by lra.
  assert (D1 := cross_near _ _ _ _ _ (x c_x - x a_x) (x c_y - x a_y) _ b_near kS2 ca_long).
  assert (D2 := cross_near _ _ _ _ _ (B_x - A_x) (B_y - A_y) _ c_near kS2 BA_long).
  assert (D3 := cross_near _ _ _ _ _ (B_x - x c_x) (B_y - x c_y) _ a_near kS2 Bc_long).
  assert (ca_long' : long (x c_y - x a_y) (x a_x - x c_x) (2 * k * S)) by (unfold long in *; lra).
  assert (G := cauchy _ _ _ _ _ _ kS2 kS2 ba_long ca_long').
  match type of N with _ <= _ * ?t + _ => set (T := t) in * end.
  assert (T1 : T <= (2 * k * S) * (2 * k * S)) by (unfold T; lra).
  assert (Z : 0 <= alpha u32 4) by (apply alpha_positive; apply bpow_ge_0).
  assert (T0 : 0 <= T) by (unfold T; repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos).
  assert (E := Rmult_le_compat _ _ _ _ Z T0 four_is T1). assert (SS : 0 <= S * S) by (apply Rmult_le_pos; lra).
  apply between in N. apply between in D1. apply between in D2. apply between in D3. unfold of_area. apply Rabs_le. lra.
Qed.
End Edge.

(* ---- m ---- *)
Definition of_leaf : Q := match bound with Mul (Add (Times c _) _) _ => c | _ => 0%Q end.
Definition of_point : Q := match bound with Mul (Add _ (Times c _)) _ => c | _ => 0%Q end.
Lemma bound_is : bound = Mul (Add (Times of_leaf (Given leaf 0)) (Times of_point (Given distance 0))) (Given off 0).
Proof. reflexivity. Qed.

(* (q + S) (a S + b R), from these a and b on, is more than e's error, 1.75 u (S + R) (S + q) and the area's. A size is
   computed with 3 roundings, `off` with 2, m with 4. *)
Definition least_leaf : Q := 545 # 167772160.
Definition least_point : Q := 986 # 1677721600.
Theorem m_is_enough_for S q R' : 0 <= S -> 0 <= q -> 0 <= R' ->
  (122 / 10 * (S * S) + 163 / 10 * (S * q) + 81 / 10 * (S * R')) * / 16777216 +
  175 / 100 * / 16777216 * ((S + R') * (S + q)) + 405 / 10 * / 16777216 * (S * S) <=
  (q + S) * (Q2R least_leaf * S + Q2R least_point * R').
Proof.
  intros S0 q0 R0. assert (SS : 0 <= S * S) by (apply Rmult_le_pos; lra). assert (Sq : 0 <= S * q) by (apply
    Rmult_le_pos; lra).
  assert (SR : 0 <= S * R') by (apply Rmult_le_pos; lra). assert (qR : 0 <= q * R') by (apply Rmult_le_pos; lra).
  replace (Q2R least_leaf) with (545 / 167772160) by (unfold Q2R, least_leaf; simpl; lra).
  replace (Q2R least_point) with (986 / 1677721600) by (unfold Q2R, least_point; simpl; lra). lra.
Qed.
(* For the kernel's sizes S and R. *)
Definition underflow_of_m : Q := 1 # 36893488147419103232.  (* 2^-65 *)
Theorem m_is_enough S q R' : 0 <= S <= 2 ^ 24 -> 0 <= q <= 2 ^ 24 -> 0 <= R' <= 2 ^ 24 ->
  ((122 / 10 * ((S + w) * (S + w)) + 163 / 10 * ((S + w) * q) + 81 / 10 * ((S + w) * (R' + w))) * / 16777216 + rest') +
  175 / 100 * / 16777216 * ((S + w + (R' + w)) * (S + w + q)) + (405 / 10 * / 16777216 * ((S + w) * (S + w)) + rest') <=
  (q + S) * (Q2R least_leaf * S + Q2R least_point * R') + Q2R underflow_of_m.
Proof.
  intros. assert (E := m_is_enough_for (S + w) q (R' + w) ltac:(lra) ltac:(lra) ltac:(lra)).
  replace (Q2R least_leaf) with (545 / 167772160) in * by (unfold Q2R, least_leaf; simpl; lra).
  replace (Q2R least_point) with (986 / 1677721600) in * by (unfold Q2R, least_point; simpl; lra).
  replace (Q2R underflow_of_m) with (/ 36893488147419103232) by (unfold Q2R, underflow_of_m; simpl; lra). simpl in *.
    lra.
Qed.
Lemma underflow_is_enough : Qle_bool (underflow_of_m / (1 - (1 # 2 ^ 24))) bound_rest = true.
Proof. vm_compute. reflexivity. Qed.
Lemma kernel_is_enough :
  Qle_bool least_leaf (of_leaf * (1 - alphaQ u32Q 10)) = true /\ Qle_bool least_point (of_point * (1 - alphaQ u32Q
    10)) = true.
Proof. vm_compute. auto. Qed.

Definition constants := Eval vm_compute in shown least_point of_point.
Print constants.
Definition rests := Eval vm_compute in shown least_leaf of_leaf.
Print rests.
Definition checked := (coordinates_near, e_near, area_near, m_is_enough, underflow_is_enough, kernel_is_enough).
Print Assumptions checked.
