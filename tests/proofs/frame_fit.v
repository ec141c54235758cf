(* SPDX-License-Identifier: MIT *)
(* light_frame.cl, fit_parallel(): the grid that is fitted to points contains the computed coordinate of each of them, so the
   clamp of texel_index() never acts (docs/numerics.md, 2).
     raw_near, offset_near, value_near   the raw coordinate, the row's offset and the coordinate in the grid;
     fitted_near                         all of them: a coordinate is within 29.4 u M scale of where the fit puts it,
                                         and what underflow takes;
     offset_is_large                     the row's offset is at least a fifth of a texel;
     point_is_inside                     so a padding of that much and the quarter of a texel keep it inside.

   Assumed: no coordinate of a point exceeds M, the greater of all; the shear is at most 1; the bounds are raw coordinates
   of points; the center is a float's rounding of their middle, and one entry of the row is 0 (here the second; the order
   of the others changes nothing: prose); a quotient is off by 2.5 ulp; at most 2^16 texels. Denormals may be kept
   or flushed: coordinates are below LARGEST_EXTENT (else the frame is indistinct), which is below 2^100, and the extent is at least the
   kernel's 1e-18, so that underflow takes less than 2^-13 texels. In prose: a face of a point light has ratios up to 1
   in place of coordinates, and no center: the same steps without some. Overflow: coordinates are below 1e30. *)
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
Definition largest_extent :=
  Const (1000000015047466219876688855040 # 1).
Definition raw :=
  Sub (Given point_x 0) (Mul (Given point_z 0) (Given shear_x 0)).
Definition value :=
  Fma (Given row 0) (Diff point_x center_x) (Fma (Given row_1 0) (Diff point_y center_y) (Fma (Given row_2 0) (Diff
    point_z center_z) (Given row_3 0))).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation computed := computes32.
Ltac take_lost C := unfold lost32 in C; cbn -[u32 h32 alpha] in C; unfold of_product in C;
  unfold alpha in C; rewrite ?u32_value in C; simpl pow in C.
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
(* 2^-90 more than the greatest coordinate: so u M is more than what underflow takes of a coordinate, a thousand times. *)
Local Notation more := (/ 2 ^ 90).
Let M := x greater_6 + more.
Let s := x quotient_1.
Let g := x shear_x.
Let P_x := x point_x. Let P_z := x point_z. Let c_x := x center_x. Let c_z := x center_z.
Variables E_x E_z : R.  (* half the extents *)
Hypotheses (s0 : 0 < s) (g_in : Rabs g <= 1) (M0 : 0 <= x greater_6).
(* Texels over the least extent (kernel_is_enough); coordinates of a frame that is not indistinct. *)
Hypotheses (s_in : s <= 2 ^ 76) (M_in : M <= 2 ^ 100).
Hypotheses (P_x_in : Rabs P_x <= M) (P_z_in : Rabs P_z <= M).
Hypotheses (E_x0 : 0 <= E_x) (E_z0 : 0 <= E_z).
Hypotheses (c_x_in : Rabs c_x + E_x <= (1 + 3 * u) * M) (c_z_in : Rabs c_z + E_z <= (1 + 3 * u) * M).
Hypothesis y_near : Rabs (x point_y - x center_y) <= 3 * M.
Hypotheses (x_near : Rabs (P_x - c_x) <= E_x + 3 * u * M) (z_near : Rabs (P_z - c_z) <= E_z + 3 * u * M).

(* The raw coordinate, which the row's map has exactly. *)
Definition real_raw := P_x - g * P_z.
Local Notation h := h32.
Lemma h_small : 0 < h /\ 0 <= M /\ h <= u * / 4000 * M /\ 0 <= h * M <= / 2 ^ 26 /\ h * M <= u * / 4000 * M /\
  0 <= s * h <= s * (u * / 4000 * M) /\ 0 <= h * h <= h /\ h <= / 2 ^ 126 /\ s * h <= / 2 ^ 50.
Proof.
  assert (h0 := h32_positive). assert (h1 := h32_below). assert (M1 : more <= M) by (unfold M; lra).
  assert (hM : h <= u * / 4000 * M) by lra.
  assert (P := fun p q (H : 0 <= p) (H' : 0 <= q) => Rmult_le_pos p q H H').
  assert (hMM : h * M <= / 2 ^ 126 * 2 ^ 100) by (apply Rmult_le_compat; lra).
  assert (hMM' : h * M <= / 2 ^ 126 * M) by (apply Rmult_le_compat_r; lra).
  assert (hs := Rmult_le_compat_l s _ _ ltac:(lra) hM).
  assert (hs' : s * h <= 2 ^ 76 * / 2 ^ 126) by (apply Rmult_le_compat; lra).
  assert (hh : h * h <= h * 1) by (apply Rmult_le_compat_l; lra).
  repeat split; try assumption; try (apply P); try lra.
Qed.
Theorem raw_near r : computed x raw r -> Rabs (r - real_raw) <= 402 / 100 * u * M.
Proof.
  intros C. apply near32 in C. take_lost C.
  destruct h_small as (h0 & M1 & hM & hMM & hMM' & hs & hh & h1 & hs').
  fold g P_x P_z in C. rewrite (Rmult_comm P_z g) in C. assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos g) (Rabs_pos P_z)
    g_in P_z_in).
  assert (P0 := Rmult_le_pos _ _ (Rabs_pos g) (Rabs_pos P_z)). assert (X0 := Rabs_pos P_x).
  assert (hP := Rmult_le_compat_l h _ _ ltac:(lra) P_z_in). assert (hg := Rmult_le_compat_l h _ _ ltac:(lra) g_in).
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
Definition real_offset := Q2R edge - s * (first - Q2R kernels_padding * x greater_6 - (c_x - g * c_z)).
Definition of_offset := u * (506 / 100 * M + 101 / 100 * E_x + 2 / 100 * E_z).
Local Notation l := (/ 2 ^ 21).  (* texels *)
Theorem offset_near o : computed x (offset_of (Given center_x 0) (Given center_z 0)) o ->
  Rabs (o - real_offset) <= s * of_offset + u * (Rabs (Q2R edge) + s * (101 / 100 * reach + 120 * u * M)) + l.
Proof.
  intros C. unfold offset_of in C.
  destruct (step32_sub _ _ _ _ C) as (e & t4 & Ce & C4 & N5). destruct (step32_mul _ _ _ _ C4) as (s' & t3 & Cs & C3 & N4).
  destruct (step32_sub _ _ _ _ C3) as (t1 & t2 & C1 & C2 & N3). destruct (step32_sub _ _ _ _ C1) as (f & p & Cf & Cp & N1).
  destruct (step32_sub _ _ _ _ C2) as (c & m & Cc & Cm & N2). destruct (step32_mul _ _ _ _ Cm) as (c' & g' & Cc' & Cg & Nm).
  destruct (step32_times _ _ _ _ Cp) as (M' & CM & Np).
  apply given32_is in Cs, Cf, Cc, Cc', Cg, CM. subst s' f c c' g' M'. fold s in N4. fold first in N1.
  fold c_x in N2. fold c_z g in Nm. destruct h_small as (h0 & M1 & hM & hMM & hMM' & hs & hh & h1 & hs').
  apply const32_is in Ce. subst e.
  set (K := Q2R kernels_padding) in *. set (m' := x greater_6) in *. assert (mM : m' <= M) by (unfold M; fold m'; lra).
  assert (KM : 0 <= K * m' <= 100 * u * M) by (split; [apply Rmult_le_pos; lra |]; apply Rmult_le_compat; lra).
  rewrite (Rabs_pos_eq K) in Np by lra. assert (hK := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 padding_small)).
  fold K in hK.
  apply (at_most32 _ _ (100 * u * M)) in Np; [| rewrite Rabs_pos_eq; lra].
  assert (Gz : Rabs (c_z * g) <= (1 + 3 * u) * M - E_z) by (rewrite Rmult_comm; apply g_times; lra).
  assert (Nh : 2 * h * (Rabs c_z + Rabs g + 1) <= 1 / 1000 * u * M + 4 * h).
  { assert (H := Rmult_le_compat_l h _ _ ltac:(lra) g_in).
    assert (H' := Rmult_le_compat_l h (Rabs c_z) (2 * M) ltac:(lra) ltac:(lra)). lra. }
  apply (at_most32 _ _ _ _ Nm) in Gz as Nm'. clear Nm.
  apply between in Np, Nm', Gz.
  assert (X0 := between _ _ (Rle_refl (Rabs c_x))). assert (Z0 := between _ _ (Rle_refl (Rabs c_z))).
  apply (at_most32 _ _ (202 / 100 * M)) in N1; [| apply between in first_in; apply Rabs_le; lra].
  apply (at_most32 _ _ (201 / 100 * M - E_x - E_z)) in N2; [| apply Rabs_le; lra].
  apply between in N1, N2, first_near.
  assert (S3 : Rabs (t1 - t2) <= reach + 110 * u * M) by (apply Rabs_le; unfold reach in *; lra).
  apply (at_most32 _ _ _ _ N3) in S3 as N3'. clear N3. apply between in N3', S3.
  assert (S4 : Rabs (s * t3) <= s * (1001 / 1000 * (reach + 111 * u * M))).
  { rewrite Rabs_mult, Rabs_pos_eq by lra. apply Rmult_le_compat_l; [lra |]. apply Rabs_le. unfold reach in *. lra. }
  assert (t3_in : Rabs t3 <= 6 * M) by (apply Rabs_le; unfold reach in *; lra).
  assert (Nh4 : 2 * h * (Rabs s + Rabs t3 + 1) <= s * (2 / 1000 * u * M) + l * / 2).
  { rewrite (Rabs_pos_eq s) by lra. assert (H := Rmult_le_compat_l h _ _ ltac:(lra) t3_in). lra. }
  apply (at_most32 _ _ _ _ N4) in S4 as N4'. clear N4.
  set (T := first - K * m' - (c_x - g * c_z)) in *.
  assert (t3_near : Rabs (t3 - T) <= u * (505 / 100 * M + 1 / 10000 * E_x - 99 / 100 * E_z)) by (apply Rabs_le; unfold T,
    reach in *; lra).
  assert (G : Rabs (s * (t3 - T)) <= s * (u * (505 / 100 * M + 1 / 10000 * E_x - 99 / 100 * E_z))).
  { rewrite Rabs_mult, (Rabs_pos_eq s) by lra. apply Rmult_le_compat_l; lra. }
  assert (e0 := between _ _ (Rle_refl (Rabs (Q2R edge)))). apply between in S4, N4', G.
  assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra). assert (sx : 0 <= s * E_x) by (apply Rmult_le_pos; lra).
  assert (sz : 0 <= s * E_z) by (apply Rmult_le_pos; lra).
  assert (reach0 : 0 <= s * (reach + 111 * u * M)) by (apply Rmult_le_pos; unfold reach; lra).
  assert (S5 : Rabs (Q2R edge - t4) <= Rabs (Q2R edge) + s * (101 / 100 * reach + 120 * u * M) + l).
  { apply Rabs_le. unfold reach in *. lra. }
  apply (at_most32 _ _ _ _ N5) in S5. apply between in S5. apply Rabs_le. unfold real_offset, of_offset. fold K m'. fold T.
  unfold reach in *. lra.
Qed.

(* Of a point on the box's low side along x, and of one on the side along z towards which raw coordinates fall, one is left
   of the center, so that the offset is never small. Their raw coordinates are at least `first`. *)
Lemma first_is_left p_x p_z q_x q_z p q : first <= p -> first <= q ->
  Rabs (p - (p_x - g * p_z)) <= 402 / 100 * u * M -> Rabs (q - (q_x - g * q_z)) <= 402 / 100 * u * M ->
  p_x <= c_x - E_x + 3 * u * M -> Rabs (p_z - c_z) <= E_z + 3 * u * M ->
  q_x <= c_x + E_x + 3 * u * M -> Rabs g * E_z - 3 * u * M <= g * (q_z - c_z) -> first <= c_x - g * c_z + 11 * u * M.
Proof.
  intros P Q Np Nq px pz qx qz. apply between in Np, Nq. destruct h_small as (_ & M1 & _).
  assert (G : Rabs (g * (p_z - c_z)) <= Rabs g * E_z + 3 * u * M).
  { rewrite Rabs_mult. assert (H := Rmult_le_compat_l (Rabs g) _ _ (Rabs_pos g) pz).
    assert (H' := Rmult_le_compat_r (3 * u * M) _ _ ltac:(lra) g_in). lra. }
  apply between in G. lra.
Qed.
Theorem offset_is_large o : computed x (offset_of (Given center_x 0) (Given center_z 0)) o ->
  first <= c_x - g * c_z + 11 * u * M -> Q2R edge = / 4 -> 32 * u <= Q2R kernels_padding -> / 5 <= o.
Proof.
  intros C left e_is K. apply offset_near in C. apply between in C. destruct h_small as (_ & M1 & _).
  unfold real_offset, of_offset in C. rewrite e_is, (Rabs_pos_eq (/ 4)) in C by lra.
  assert (Ex : E_x <= (1 + 3 * u) * M) by (assert (Z := Rabs_pos c_x); lra).
  assert (Ez : E_z <= (1 + 3 * u) * M) by (assert (Z := Rabs_pos c_z); lra).
  assert (D : first - Q2R kernels_padding * x greater_6 - (c_x - g * c_z) + u * (506 / 100 * M + 101 / 100 * E_x + 2 / 100 *
    E_z) + u * (101 / 100 * reach + 120 * u * M) <= 32 * u * more).
  { assert (H := Rmult_le_compat_r (x greater_6) _ _ M0 K). unfold reach, M in *. lra. }
  assert (sD := Rmult_le_compat_l s _ _ ltac:(lra) D).
  assert (s_more : s * more <= / 2 ^ 14).
  { replace (/ 2 ^ 14) with (2 ^ 76 * more) by lra. apply Rmult_le_compat_r; lra. }
  lra.
Qed.

(* The coordinate in the grid: the row is s, 0, a product that rounds once, and the offset. *)
Hypotheses (row_is : x row = s) (row_1_is : x row_1 = 0) (row_2_near : Rabs (x row_2 + s * g) <= 101 / 100 * u * s + 3 * h).
Theorem value_near v : computed x value v ->
  Rabs (v - (s * (P_x - c_x - g * (P_z - c_z)) + x row_3)) <=
  402 / 100 * u * (s * (E_x + E_z + 8 * u * M) + Rabs (x row_3)) + 101 / 100 * u * s * (E_z + 4 * u * M) + l.
Proof.
  intros C. apply near32 in C. take_lost C. destruct h_small as (h0 & M1 & hM & hMM & hMM' & hs & hh & h1 & hs').
  rewrite row_is, row_1_is, Rabs_R0, !Rmult_0_l, !Rplus_0_l in C. fold P_x P_z c_x c_z in C.
  rewrite (Rabs_pos_eq s) in C by lra.
  assert (r2 : Rabs (x row_2) <= (1 + 2 * u) * s + 3 * h).
  { assert (G := g_times 1 1 ltac:(rewrite Rabs_R1; lra)). rewrite Rmult_1_r in G. apply between in row_2_near, G.
    assert (H := Rmult_le_compat_l s (- 1) g ltac:(lra) ltac:(lra)).
    assert (I := Rmult_le_compat_l s g 1 ltac:(lra) ltac:(lra)).
    apply Rabs_le. lra. }
  assert (G1 := Rmult_le_compat_l s _ _ ltac:(lra) x_near).
  assert (G2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) r2 z_near).
  assert (G3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) row_2_near z_near). rewrite <- Rabs_mult in G3.
  assert (h2 := Rmult_le_compat_l h _ _ ltac:(lra) r2). assert (hx := Rmult_le_compat_l h _ _ ltac:(lra) x_near).
  assert (hy := Rmult_le_compat_l h _ _ ltac:(lra) y_near). assert (hz := Rmult_le_compat_l h _ _ ltac:(lra) z_near).
  assert (Ex : E_x <= (1 + 3 * u) * M) by (assert (Z := Rabs_pos c_x); lra).
  assert (Ez : E_z <= (1 + 3 * u) * M) by (assert (Z := Rabs_pos c_z); lra).
  assert (hEx := Rmult_le_compat_l h _ _ ltac:(lra) Ex). assert (hEz := Rmult_le_compat_l h _ _ ltac:(lra) Ez).
  assert (hEz0 : 0 <= h * E_z) by (apply Rmult_le_pos; lra).
  assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra). assert (sz : 0 <= s * E_z) by (apply Rmult_le_pos; lra).
  assert (o0 := Rabs_pos (x row_3)). assert (sx : 0 <= s * E_x) by (apply Rmult_le_pos; lra).
  apply between in C, G3. apply Rabs_le. lra.
Qed.

(* Where the fit puts a point. *)
Definition real_place r := Q2R edge + s * (r - first + Q2R kernels_padding * x greater_6).
Definition least_padding : Q := 294 # 167772160.
Theorem fitted_near r v : computed x raw r -> computed x value v -> computed x (offset_of (Given center_x 0) (Given
  center_z 0)) (x row_3) ->
  Rabs (v - real_place r) <= s * (Q2R least_padding * M) + 6 * u * Rabs (Q2R edge) + 3 * l.
Proof.
  intros Cr Cv Co. assert (R := raw_near _ Cr). assert (V := value_near _ Cv). assert (O := offset_near _ Co).
  destruct h_small as (_ & M1 & _). assert (mM : x greater_6 <= M) by (unfold M; lra).
  assert (sM : 0 <= s * M) by (apply Rmult_le_pos; lra). assert (e0 := Rabs_pos (Q2R edge)).
  assert (Ex : E_x <= (1 + 3 * u) * M) by (assert (Z := Rabs_pos c_x); lra).
  assert (Ez : E_z <= (1 + 3 * u) * M) by (assert (Z := Rabs_pos c_z); lra).
  assert (sx := Rmult_le_compat_l s _ _ ltac:(lra) Ex). assert (sz := Rmult_le_compat_l s _ _ ltac:(lra) Ez).
  assert (sx0 : 0 <= s * E_x) by (apply Rmult_le_pos; lra). assert (sz0 : 0 <= s * E_z) by (apply Rmult_le_pos; lra).
  assert (Km : 0 <= Q2R kernels_padding * x greater_6 <= 100 * u * M)
    by (split; [apply Rmult_le_pos; lra | apply Rmult_le_compat; lra]).
  assert (KM : 0 <= s * (Q2R kernels_padding * x greater_6) <= s * (100 * u * M))
    by (split; [apply Rmult_le_pos; lra | apply Rmult_le_compat_l; lra]).
  assert (o_size : Rabs (x row_3) <= Rabs (Q2R edge) + s * (E_x + E_z + 200 * u * M) + u * Rabs (Q2R edge) + 2 * l).
  { assert (T := Rabs_triang_inv (x row_3) real_offset). unfold real_offset in T at 1.
    assert (T' := Rabs_triang (Q2R edge) (- (s * (first - Q2R kernels_padding * x greater_6 - (c_x - g * c_z))))).
    rewrite Rabs_Ropp, Rabs_mult, (Rabs_pos_eq s) in T' by lra.
    assert (F : Rabs (first - Q2R kernels_padding * x greater_6 - (c_x - g * c_z)) <= reach + 100 * u * M).
    { apply between in first_near. apply Rabs_le. lra. }
    assert (G := Rmult_le_compat_l s _ _ ltac:(lra) F). unfold Rminus in *. unfold of_offset, reach in *. lra. }
  assert (sR : Rabs (s * (r - real_raw)) <= s * (402 / 100 * u * M)).
  { rewrite Rabs_mult, (Rabs_pos_eq s) by lra. apply Rmult_le_compat_l; lra. }
  apply between in sR, V, O. unfold real_place, real_raw, real_offset, of_offset, reach in *.
  replace (Q2R least_padding) with (294 / 167772160) by (unfold Q2R, least_padding; simpl; lra).
  apply Rabs_le. lra.
Qed.

(* The scale is a quotient of the texels but half a one and the extent. *)
Theorem point_is_inside r v last width extent : computed x raw r -> computed x value v ->
  computed x (offset_of (Given center_x 0) (Given center_z 0)) (x row_3) ->
  first <= r <= last -> 1 <= width <= 65536 -> 0 < extent -> Q2R edge = / 4 ->
  Q2R least_padding <= Q2R kernels_padding ->
  (1 - 4 * u) * (last - first + 2 * (Q2R kernels_padding * x greater_6)) - more <= extent ->
  s * extent <= (1 + 7 * u) * (width - / 2) -> 0 < v < width.
Proof.
  intros Cr Cv Co [F L] W X0 e_is enough extent_is scale_is. assert (N := fitted_near _ _ Cr Cv Co).
  rewrite e_is in N. rewrite (Rabs_pos_eq (/ 4)) in N by lra. apply between in N. unfold real_place in N. rewrite e_is in N.
  assert (sm : 0 <= s * x greater_6) by (apply Rmult_le_pos; lra).
  assert (pad := Rmult_le_compat_r _ _ _ sm enough).
  assert (s_more : s * more <= / 2 ^ 14).
  { replace (/ 2 ^ 14) with (2 ^ 76 * more) by lra. apply Rmult_le_compat_r; lra. }
  replace (Q2R least_padding) with (294 / 167772160) in * by (unfold Q2R, least_padding; simpl; lra). unfold M in N.
  assert (G1 := Rmult_le_compat_l s _ _ ltac:(lra) F). assert (G2 := Rmult_le_compat_l s _ _ ltac:(lra) L).
  assert (G3 := Rmult_le_compat_l s _ _ ltac:(lra) extent_is). lra.
Qed.
End Fit.
Definition least_extent : Q := match greater_7_other with Const c => c | _ => 0%Q end.
Definition extent_of e : Q := match e with Const c => c | _ => 0%Q end.
Lemma kernel_is_enough : Qle_bool least_padding kernels_padding = true /\ Qle_bool kernels_padding (100 # 16777216) = true /\
  Qle_bool ((1 + (7 # 2 ^ 24)) * 65536) (2 ^ 76 * least_extent) = true /\
  Qle_bool (extent_of largest_extent + (1 # 2 ^ 90)) (2 ^ 100) = true.
Proof. vm_compute. auto. Qed.

Definition constants := Eval vm_compute in shown least_padding kernels_padding.
Print constants.
Definition checked := (raw_near, offset_near, first_is_left, offset_is_large, value_near, fitted_near, point_is_inside, kernel_is_enough).
Print Assumptions checked.
