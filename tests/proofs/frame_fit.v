(* SPDX-License-Identifier: MIT *)
(* light_frame.cl, fit_parallel(): the grid that is fitted to points contains the computed coordinate of each of them, so the
   clamp of texel_index() never acts (docs/numerics.md, 2).
     raw_near, offset_near, value_near   the raw coordinate, the row's offset and the coordinate in the grid;
     fitted_near                         all of them: a coordinate is within 29.3 u M scale of where the fit puts it;
     point_is_inside                     so a padding of that much keeps it inside.

   Assumed: no coordinate of a point exceeds M, the greater of all; the shear is at most 1; the bounds are raw coordinates
   of points; the center is a float's rounding of their middle, and one entry of the row is 0 (here the second; the order
   of the others changes nothing: prose); a quotient is off by 2.5 ulp; at most 2^16 texels; no result is below 2^-126
   unless it is 0. In prose: a face of a point light has ratios up to 1 in place of coordinates, and no center: the same
   steps without some. Overflow: coordinates are below 1e30. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition low_x := 0%nat.
Definition low_y := 1%nat.
Definition low_z := 2%nat.
Definition high_x := 3%nat.
Definition high_y := 4%nat.
Definition high_z := 5%nat.
Definition raw_low_x := 6%nat.
Definition raw_high_x := 7%nat.
Definition shear_x := 8%nat.
Definition width := 9%nat.
Definition point_x := 10%nat.
Definition point_y := 11%nat.
Definition point_z := 12%nat.
Definition center_x := 13%nat.
Definition center_y := 14%nat.
Definition center_z := 15%nat.
Definition row := 16%nat.
Definition row_1 := 17%nat.
Definition row_2 := 18%nat.
Definition row_3 := 19%nat.
Definition greater_1 := 20%nat.
Definition greater_2 := 21%nat.
Definition greater_3 := 22%nat.
Definition greater_4 := 23%nat.
Definition greater_5 := 24%nat.
Definition greater_6 := 25%nat.
Definition greater_7 := 26%nat.
Definition quotient_1 := 27%nat.
Definition greater_1_one :=
  Abs (Given high_z 0).
Definition greater_1_other :=
  Abs (Given low_z 0).
Definition greater_2_one :=
  Abs (Given high_y 0).
Definition greater_2_other :=
  Abs (Given low_y 0).
Definition greater_3_one :=
  Abs (Given high_x 0).
Definition greater_3_other :=
  Abs (Given low_x 0).
Definition greater_4_one :=
  Const (0 # 1).
Definition greater_4_other := Given greater_3 0.
Definition greater_5_one := Given greater_2 0.
Definition greater_5_other := Given greater_4 0.
Definition greater_6_one := Given greater_1 0.
Definition greater_6_other := Given greater_5 0.
Definition greater_7_one :=
  Add (Times (2 # 1) (Times (1 # 524288) (Given greater_6 0))) (Diff raw_high_x raw_low_x).
Definition greater_7_other :=
  Const (9671407 # 9671406556917033397649408).
Definition quotient_1_over :=
  Add (Const (-1 # 2)) (Given width 0).
Definition quotient_1_under := Given greater_7 0.
Definition scale := Given quotient_1 0.
Definition row_z :=
  Mul (Given shear_x 0) (Neg (Given quotient_1 0)).
Definition offset :=
  Sub (Const (1 # 4)) (Mul (Given quotient_1 0) (Sub (Sub (Given raw_low_x 0) (Times (1 # 524288) (Given greater_6
    0))) (Sub (Add (Times (1 # 2) (Given high_x 0)) (Times (1 # 2) (Given low_x 0))) (Mul (Add (Times (1 # 2) (Given
    high_z 0)) (Times (1 # 2) (Given low_z 0))) (Given shear_x 0))))).
Definition raw :=
  Sub (Given point_x 0) (Mul (Given point_z 0) (Given shear_x 0)).
Definition value :=
  Fma (Given row 0) (Diff point_x center_x) (Fma (Given row_1 0) (Diff point_y center_y) (Fma (Given row_2 0) (Diff
    point_z center_z) (Given row_3 0))).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Definition kernels_padding : Q := match greater_7_one with Add (Times _ (Times c _)) _ => c | _ => 0%Q end.
Definition edge : Q := match offset with Sub (Const c) _ => c | _ => 0%Q end.
Definition middle i j := Add (Times (1 # 2) (Given i 0)) (Times (1 # 2) (Given j 0)).
Definition padding := Times kernels_padding (Given greater_6 0).
(* The offset for a center's coordinates a and b, which are floats: the same as in `value`. *)
Definition offset_of a b :=
  Sub (Const edge) (Mul (Given quotient_1 0) (Sub (Sub (Given raw_low_x 0) padding) (Sub a (Mul b (Given shear_x 0))))).
Lemma offset_is : offset = offset_of (middle high_x low_x) (middle high_z low_z).
Proof. reflexivity. Qed.
Lemma extent_is :
  greater_7_one = Add (Times 2 padding) (Diff raw_high_x raw_low_x) /\
  quotient_1_over = Add (Const (-1 # 2)) (Given width 0) /\ Qred (2 * edge) = (1 # 2)%Q /\ quotient_1_under = Given
    greater_7 0 /\
  scale = Given quotient_1 0.
Proof. repeat split. Qed.

Section Fit.
Variable x : nat -> R.
Let M := x greater_6.
Let s := x quotient_1.
Let g := x shear_x.
Let P_x := x point_x. Let P_z := x point_z. Let c_x := x center_x. Let c_z := x center_z.
Variables E_x E_z : R.  (* half the extents *)
Hypotheses (s0 : 0 < s) (g_in : Rabs g <= 1) (M0 : 0 <= M).
Hypotheses (P_x_in : Rabs P_x <= M) (P_z_in : Rabs P_z <= M).
Hypotheses (E_x0 : 0 <= E_x) (E_z0 : 0 <= E_z).
Hypotheses (c_x_in : Rabs c_x + E_x <= (1 + 3 * u) * M) (c_z_in : Rabs c_z + E_z <= (1 + 3 * u) * M).
Hypotheses (x_near : Rabs (P_x - c_x) <= E_x + 3 * u * M) (z_near : Rabs (P_z - c_z) <= E_z + 3 * u * M).

(* The raw coordinate, which the row's map has exactly. *)
Definition real_raw := P_x - g * P_z.
Theorem raw_near r : computed x raw r -> Rabs (r - real_raw) <= 401 / 100 * u * M.
Proof.
  intros C. apply near in C. assert (A := alpha_below 2 ltac:(lia)). simpl INR in A. cbn -[u32 alpha] in C.
  fold g P_x P_z in C. rewrite (Rmult_comm P_z g) in C. assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos g) (Rabs_pos P_z)
    g_in P_z_in).
  assert (P0 := Rmult_le_pos _ _ (Rabs_pos g) (Rabs_pos P_z)). assert (X0 := Rabs_pos P_x).
  assert (B : alpha u32 2 * (Rabs P_x + Rabs g * Rabs P_z) <= (1 + 1) * (1 + / 1048576) * u * (2 * M))
    by (apply Rmult_le_compat; [apply alpha_at_least | lra | exact A | lra]).
  unfold real_raw. lra.
Qed.

(* How far a raw coordinate of a point is from the center's. *)
Let reach := E_x + E_z + 8 * u * M.
Lemma g_times a b : Rabs a <= b -> Rabs (g * a) <= b.
Proof. intros H. rewrite Rabs_mult. assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos g) (Rabs_pos a) g_in H). lra. Qed.

(* The row's offset. *)
Variable low : R.
Let first := x raw_low_x.
Hypothesis first_in : Rabs first <= 201 / 100 * M.
Hypothesis first_near : Rabs (first - (c_x - g * c_z)) <= reach.
Hypothesis padding_small : 0 <= Q2R kernels_padding <= 100 * u.
Definition real_offset := Q2R edge - s * (first - Q2R kernels_padding * M - (c_x - g * c_z)).
Definition of_offset := u * (505 / 100 * M + 101 / 100 * E_x + 2 / 100 * E_z).
Theorem offset_near o : computed x (offset_of (Given center_x 0) (Given center_z 0)) o ->
  Rabs (o - real_offset) <= s * of_offset + u * (Rabs (Q2R edge) + s * (101 / 100 * reach + 120 * u * M)).
Proof.
  intros C. unfold offset_of in C.
  destruct (step_sub _ _ _ _ C) as (e & t4 & Ce & C4 & N5). destruct (step_mul _ _ _ _ C4) as (s' & t3 & Cs & C3 & N4).
  destruct (step_sub _ _ _ _ C3) as (t1 & t2 & C1 & C2 & N3). destruct (step_sub _ _ _ _ C1) as (f & p & Cf & Cp & N1).
  destruct (step_sub _ _ _ _ C2) as (c & m & Cc & Cm & N2). destruct (step_mul _ _ _ _ Cm) as (c' & g' & Cc' & Cg & Nm).
  destruct (step_times _ _ _ _ Cp) as (M' & CM & Np).
  apply given_is in Cs, Cf, Cc, Cc', Cg, CM. subst s' f c c' g' M'. fold s in N4. fold first in N1.
  fold c_x in N2. fold c_z g in Nm. fold M in Np.
  assert (e_is : e = Q2R edge) by (destruct Ce as [Ce _]; inversion Ce; reflexivity). subst e.
  set (K := Q2R kernels_padding) in *. assert (KM : 0 <= K * M <= 100 * u * M) by (split; [apply Rmult_le_pos; lra |];
    apply Rmult_le_compat_r; lra).
  apply (at_most _ _ (100 * u * M)) in Np; [| rewrite Rabs_pos_eq; lra].
  assert (Gz : Rabs (c_z * g) <= (1 + 3 * u) * M - E_z) by (rewrite Rmult_comm; apply g_times; lra).
  apply (at_most _ _ _ Nm) in Gz as Nm'. clear Nm.
  apply between in Np, Nm', Gz.
  assert (X0 := between _ _ (Rle_refl (Rabs c_x))). assert (Z0 := between _ _ (Rle_refl (Rabs c_z))).
  apply (at_most _ _ (202 / 100 * M)) in N1; [| apply between in first_in; apply Rabs_le; lra].
  apply (at_most _ _ (201 / 100 * M - E_x - E_z)) in N2; [| apply Rabs_le; lra].
  apply between in N1, N2, first_near.
  assert (S3 : Rabs (t1 - t2) <= reach + 110 * u * M) by (apply Rabs_le; unfold reach in *; lra).
  apply (at_most _ _ _ N3) in S3 as N3'. clear N3. apply between in N3', S3.
  assert (S4 : Rabs (s * t3) <= s * (1001 / 1000 * (reach + 111 * u * M))).
  { rewrite Rabs_mult, Rabs_pos_eq by lra. apply Rmult_le_compat_l; [lra |]. apply Rabs_le. unfold reach in *. lra. }
  apply (at_most _ _ _ N4) in S4 as N4'. clear N4.
  set (T := first - K * M - (c_x - g * c_z)) in *.
  assert (t3_near : Rabs (t3 - T) <= u * (504 / 100 * M + 1 / 10000 * E_x - 99 / 100 * E_z)) by (apply Rabs_le; unfold T,
    reach in *; lra).
  assert (G : Rabs (s * (t3 - T)) <= s * (u * (504 / 100 * M + 1 / 10000 * E_x - 99 / 100 * E_z))).
  { rewrite Rabs_mult, (Rabs_pos_eq s) by lra. apply Rmult_le_compat_l; lra. }
  assert (e0 := between _ _ (Rle_refl (Rabs (Q2R edge)))). apply between in S4, N4', G.
  assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra). assert (sx : 0 <= s * E_x) by (apply Rmult_le_pos; lra).
  assert (sz : 0 <= s * E_z) by (apply Rmult_le_pos; lra).
  assert (reach0 : 0 <= s * (reach + 111 * u * M)) by (apply Rmult_le_pos; unfold reach; lra).
  assert (S5 : Rabs (Q2R edge - t4) <= Rabs (Q2R edge) + s * (101 / 100 * reach + 120 * u * M)).
  { apply Rabs_le. unfold reach in *. lra. }
  apply (at_most _ _ _ N5) in S5. apply between in S5. apply Rabs_le. unfold real_offset, of_offset. fold K. fold T.
  unfold reach in *. lra.
Qed.

(* The coordinate in the grid: the row is s, 0, a product that rounds once, and the offset. *)
Hypotheses (row_is : x row = s) (row_1_is : x row_1 = 0) (row_2_near : Rabs (x row_2 + s * g) <= u * s).
Theorem value_near v : computed x value v ->
  Rabs (v - (s * (P_x - c_x - g * (P_z - c_z)) + x row_3)) <=
  401 / 100 * u * (s * (E_x + E_z + 8 * u * M) + Rabs (x row_3)) + u * s * (E_z + 4 * u * M).
Proof.
  intros C. apply near in C. assert (A := alpha_below 4 ltac:(lia)). simpl INR in A. cbn -[u32 alpha] in C.
  rewrite row_is, row_1_is, Rabs_R0, !Rmult_0_l, !Rplus_0_l in C. fold P_x P_z c_x c_z in C.
  rewrite (Rabs_pos_eq s) in C by lra.
  assert (r2 : Rabs (x row_2) <= (1 + u) * s).
  { assert (G := g_times 1 1 ltac:(rewrite Rabs_R1; lra)). rewrite Rmult_1_r in G. apply between in row_2_near, G.
    assert (H := Rmult_le_compat_l s (- 1) g ltac:(lra) ltac:(lra)).
    assert (I := Rmult_le_compat_l s g 1 ltac:(lra) ltac:(lra)).
    apply Rabs_le. lra. }
  assert (G1 := Rmult_le_compat_l s _ _ ltac:(lra) x_near).
  assert (G2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) r2 z_near).
  assert (G3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) row_2_near z_near). rewrite <- Rabs_mult in G3.
  set (Q := s * Rabs (P_x - c_x) + (Rabs (x row_2) * Rabs (P_z - c_z) + Rabs (x row_3))) in *.
  assert (Q0 : 0 <= Q) by (unfold Q; repeat apply Rplus_le_le_0_compat; try apply Rmult_le_pos; auto using Rabs_pos; lra).
  assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra). assert (sz : 0 <= s * E_z) by (apply Rmult_le_pos; lra).
  assert (Q1 : Q <= s * (E_x + E_z + 7 * u * M + u * E_z) + Rabs (x row_3)) by (unfold Q; lra).
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 4) Q0 A Q1).
  assert (o0 := Rabs_pos (x row_3)). assert (sx : 0 <= s * E_x) by (apply Rmult_le_pos; lra).
  apply between in C, G3. apply Rabs_le. lra.
Qed.

(* Where the fit puts a point. *)
Definition real_place r := Q2R edge + s * (r - first + Q2R kernels_padding * M).
Definition least_padding : Q := 293 # 167772160.
Theorem fitted_near r v : computed x raw r -> computed x value v -> computed x (offset_of (Given center_x 0) (Given
  center_z 0)) (x row_3) ->
  Rabs (v - real_place r) <= s * (Q2R least_padding * M) + 6 * u * Rabs (Q2R edge).
Proof.
  intros Cr Cv Co. assert (R := raw_near _ Cr). assert (V := value_near _ Cv). assert (O := offset_near _ Co).
  assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra). assert (e0 := Rabs_pos (Q2R edge)).
  assert (Ex : E_x <= (1 + 3 * u) * M) by (assert (Z := Rabs_pos c_x); lra).
  assert (Ez : E_z <= (1 + 3 * u) * M) by (assert (Z := Rabs_pos c_z); lra).
  assert (sx := Rmult_le_compat_l s _ _ ltac:(lra) Ex). assert (sz := Rmult_le_compat_l s _ _ ltac:(lra) Ez).
  assert (sx0 : 0 <= s * E_x) by (apply Rmult_le_pos; lra). assert (sz0 : 0 <= s * E_z) by (apply Rmult_le_pos; lra).
  assert (KM : 0 <= s * (Q2R kernels_padding * M) <= 100 * u * (s * M)).
  { split; [apply Rmult_le_pos; [lra | apply Rmult_le_pos; lra] |].
  replace (100 * u * (s * M)) with (s * (100 * u * M)) by ring.
    apply Rmult_le_compat_l; [lra |]. apply Rmult_le_compat_r; lra. }
  assert (o_size : Rabs (x row_3) <= Rabs (Q2R edge) + s * (E_x + E_z + 200 * u * M) + u * Rabs (Q2R edge)).
  { assert (T := Rabs_triang_inv (x row_3) real_offset). unfold real_offset in T at 1.
    assert (T' := Rabs_triang (Q2R edge) (- (s * (first - Q2R kernels_padding * M - (c_x - g * c_z))))).
    rewrite Rabs_Ropp, Rabs_mult, (Rabs_pos_eq s) in T' by lra.
    assert (F : Rabs (first - Q2R kernels_padding * M - (c_x - g * c_z)) <= reach + 100 * u * M).
    { assert (0 <= Q2R kernels_padding * M <= 100 * u * M) by (split; [apply Rmult_le_pos; lra |]; apply
      Rmult_le_compat_r; lra).
      apply between in first_near. apply Rabs_le. lra. }
    assert (G := Rmult_le_compat_l s _ _ ltac:(lra) F). unfold Rminus in *. unfold of_offset, reach in *. lra. }
  assert (sR : Rabs (s * (r - real_raw)) <= s * (401 / 100 * u * M)).
  { rewrite Rabs_mult, (Rabs_pos_eq s) by lra. apply Rmult_le_compat_l; lra. }
  apply between in sR, V, O. unfold real_place, real_raw, real_offset, of_offset, reach in *.
  replace (Q2R least_padding) with (293 / 167772160) by (unfold Q2R, least_padding; simpl; lra).
  apply Rabs_le. lra.
Qed.

(* The scale is a quotient of the texels but half a one and the extent. *)
Theorem point_is_inside r v last width extent : computed x raw r -> computed x value v ->
  computed x (offset_of (Given center_x 0) (Given center_z 0)) (x row_3) ->
  first <= r <= last -> 1 <= width <= 65536 -> 0 < extent -> Q2R edge = / 4 ->
  Q2R least_padding <= Q2R kernels_padding ->
  (1 - 4 * u) * (last - first + 2 * (Q2R kernels_padding * M)) <= extent ->
  s * extent <= (1 + 7 * u) * (width - / 2) -> 0 < v < width.
Proof.
  intros Cr Cv Co [F L] W X0 e_is enough extent_is scale_is. assert (N := fitted_near _ _ Cr Cv Co).
  rewrite e_is in N. rewrite (Rabs_pos_eq (/ 4)) in N by lra. apply between in N. unfold real_place in N. rewrite e_is in N.
  assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra).
  assert (pad := Rmult_le_compat_r _ _ _ sM enough).
  assert (G1 := Rmult_le_compat_l s _ _ ltac:(lra) F). assert (G2 := Rmult_le_compat_l s _ _ ltac:(lra) L).
  assert (G3 := Rmult_le_compat_l s _ _ ltac:(lra) extent_is). lra.
Qed.
End Fit.
Lemma kernel_is_enough : Qle_bool least_padding kernels_padding = true /\ Qle_bool kernels_padding (100 # 16777216) = true.
Proof. vm_compute. auto. Qed.

Definition constants := Eval vm_compute in shown least_padding kernels_padding.
Print constants.
Definition checked := (raw_near, offset_near, value_near, fitted_near, point_is_inside, kernel_is_enough).
Print Assumptions checked.
