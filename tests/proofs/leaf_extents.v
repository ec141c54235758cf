(* SPDX-License-Identifier: MIT *)
(* parallel_packets.clh: where a leaf's triangles and a block's points lie along an axis of the light: a triangle
   that is computed to end before the points' box begins does so (docs/numerics.md, 16). The other sides have the
   same terms.
     corner_near, triangle_near, box_near   the greatest coordinate of a triangle, and the least one of the box;
     outside_is_outside                     so a triangle that is left out is outside by 4 u L.

   Assumed: the axis has unit length to 10^-4, so that its coordinates add up to at most 1.733; no coordinate of a
   corner or a point exceeds L; `rounding` is at least 0.9999 of BEAM_ROUNDING L + BEAM_ROUNDING_LEAST, and at most L + 1.
   Denormals may be kept or flushed. A greater of two is one of them and at least both, or 2^-126 less where it
   flushes one; dot() rounds each product and each sum, in any order. In prose: that the axis is not exactly
   perpendicular to D moves a coordinate by at most 3 u L. Overflow: coordinates are at most 2^19. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition A_x := 0%nat.
Definition A_y := 1%nat.
Definition A_z := 2%nat.
Definition B_x := 3%nat.
Definition B_y := 4%nat.
Definition B_z := 5%nat.
Definition C_x := 6%nat.
Definition C_y := 7%nat.
Definition C_z := 8%nat.
Definition O_x := 9%nat.
Definition O_y := 10%nat.
Definition O_z := 11%nat.
Definition low_x := 12%nat.
Definition low_y := 13%nat.
Definition low_z := 14%nat.
Definition high_x := 15%nat.
Definition high_y := 16%nat.
Definition high_z := 17%nat.
Definition rounding := 18%nat.
Definition axes_0_0 := 19%nat.
Definition axes_0_1 := 20%nat.
Definition axes_0_2 := 21%nat.
Definition same_0_0_0 := 22%nat.
Definition same_0_0_1 := 23%nat.
Definition same_0_0_2 := 24%nat.
Definition greater_1 := 25%nat.
Definition greater_2 := 26%nat.
Definition corner :=
  Fma (Given axes_0_0 0) (Diff A_x O_x) (Fma (Given axes_0_1 0) (Diff A_y O_y) (Mul (Given axes_0_2 0) (Diff A_z
    O_z))).
Definition greater_1_one :=
  corner.
Definition greater_1_other :=
  Fma (Given axes_0_0 0) (Diff B_x O_x) (Fma (Given axes_0_1 0) (Diff B_y O_y) (Mul (Given axes_0_2 0) (Diff B_z
    O_z))).
Definition greater_2_one :=
  Fma (Given axes_0_0 0) (Diff C_x O_x) (Fma (Given axes_0_1 0) (Diff C_y O_y) (Mul (Given axes_0_2 0) (Diff C_z
    O_z))).
Definition greater_2_other := Given greater_1 0.
Definition triangle_high :=
  Add (Fma (Given O_x 0) (Given axes_0_0 0) (Fma (Given O_y 0) (Given axes_0_1 0) (Mul (Given O_z 0) (Given axes_0_2
    0)))) (Given greater_2 0).
Definition box_low :=
  Sub (Add (Add (Mul (Given same_0_0_0 0) (Times (1 # 2) (Add (Given high_x 0) (Given low_x 0)))) (Mul (Given
    same_0_0_1 0) (Times (1 # 2) (Add (Given high_y 0) (Given low_y 0))))) (Mul (Given same_0_0_2 0) (Times (1 # 2)
    (Add (Given high_z 0) (Given low_z 0))))) (Add (Add (Add (Mul (Abs (Given same_0_0_0 0)) (Times (1 # 2) (Diff
    high_x low_x))) (Mul (Abs (Given same_0_0_1 0)) (Times (1 # 2) (Diff high_y low_y)))) (Mul (Abs (Given
    same_0_0_2 0)) (Times (1 # 2) (Diff high_z low_z)))) (Given rounding 0)).
Definition factor :=
  Const (8796093 # 2199023255552).
Definition of_nothing :=
  Const (332307 # 332306998946228968225951765070086144).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation computed := computes32.
Local Notation tiny' := (/ 1298074214633706907132624082305024).

Section Axis.
Variable x : nat -> R.
Variable L : R.
Let a_x := x axes_0_0. Let a_y := x axes_0_1. Let a_z := x axes_0_2.
Let along p q r := a_x * p + (a_y * q + a_z * r).
Hypotheses (same_x : x same_0_0_0 = a_x) (same_y : x same_0_0_1 = a_y) (same_z : x same_0_0_2 = a_z).
Hypotheses (unit_length : Rabs a_x + Rabs a_y + Rabs a_z <= 1733 / 1000).
Let within i := Rabs (x i) <= L.
Hypotheses (A_x_in : within A_x) (A_y_in : within A_y) (A_z_in : within A_z).
Hypotheses (O_x_in : within O_x) (O_y_in : within O_y) (O_z_in : within O_z).
Hypotheses (l_x_in : within low_x) (l_y_in : within low_y) (l_z_in : within low_z).
Hypotheses (h_x_in : within high_x) (h_y_in : within high_y) (h_z_in : within high_z).

Lemma L0 : 0 <= L.
Proof. eapply Rle_trans; [apply Rabs_pos | exact A_x_in]. Qed.
Lemma sum_below p q r m : 0 <= m -> p <= m -> q <= m -> r <= m ->
  Rabs a_x * p + (Rabs a_y * q + Rabs a_z * r) <= 1733 / 1000 * m.
Proof.
  intros. assert (H3 := Rmult_le_compat_l _ _ _ (Rabs_pos a_x) H0).
  assert (H4 := Rmult_le_compat_l _ _ _ (Rabs_pos a_y) H1).
  assert (H5 := Rmult_le_compat_l _ _ _ (Rabs_pos a_z) H2). assert (H6 := Rmult_le_compat_r m _ _ H unit_length). lra.
Qed.
Lemma difference_below i j : within i -> within j -> Rabs (x i - x j) <= 2 * L.
Proof. unfold within. intros. apply between in H. apply between in H0. apply Rabs_le. lra. Qed.

(* Axes are up to 2, coordinates up to L, a greatest coordinate along an axis up to 4 L. *)
Let caps i : polynomial := if Nat.leb i high_z then line 0 1 else if Nat.leb i rounding then line 1 1 else if Nat.leb
  i same_0_0_2 then number 2 else line 0 4.
Let gaps (i j : nat) : polynomial := line 0 2.
Lemma axes_in : Rabs a_x <= 2 /\ Rabs a_y <= 2 /\ Rabs a_z <= 2.
Proof. assert (A := Rabs_pos a_x). assert (B := Rabs_pos a_y). assert (C := Rabs_pos a_z). lra. Qed.

Theorem corner_near c : computed x corner c ->
  Rabs (c - along (x A_x - x O_x) (x A_y - x O_y) (x A_z - x O_z)) <= 139 / 10 * u * L + tiny'.
Proof.
  intros C. assert (l0 := L0). destruct axes_in as (ax & ay & az). unfold a_x, a_y, a_z in ax, ay, az.
  apply (near_at_size x caps gaps L (line tiny tiny)) in C;
    [ | exact l0 | vm_compute; reflexivity
    | assert (d := difference_below); unfold within in *; within_sizes; eapply Rle_trans; [now apply d | lra | now
      apply d | lra | now apply d | lra] ].
  unfold line in C. cbn [at_size] in C. rewrite tiny_is in C. clear ax ay az. assert (A := alpha_below 4 ltac:(lia)).
    simpl INR in A. cbn -[u32 alpha] in C.
  fold a_x a_y a_z in C.
  assert (P := sum_below _ _ _ (2 * L) ltac:(lra) (difference_below _ _ A_x_in O_x_in) (difference_below _ _ A_y_in
    O_y_in)
    (difference_below _ _ A_z_in O_z_in)).
  match type of C with _ <= _ * ?p + _ => assert (P0 : 0 <= p) end.
  { repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos. }
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 4) P0 A P). unfold along. lra.
Qed.

(* c_A is the computed corner A, one of the results that its expression may have; g is the greatest of the computed
   corners, each of which is as large as corner_near allows. *)
Let g := x greater_2.
Variable c_A : R.
Hypotheses (g_is : Rabs g <= 2 * (1734 / 1000) * L + tiny') (c_A_is : computed x corner c_A) (A_below_g : c_A <= g + h32).
Theorem triangle_near t : computed x triangle_high t ->
  along (x A_x) (x A_y) (x A_z) - 244 / 10 * u * L - 3 * tiny' <= t.
Proof.
  intros C. assert (l0 := L0). destruct axes_in as (ax & ay & az). unfold a_x, a_y, a_z in ax, ay, az. assert (N :=
    corner_near _ c_A_is). assert (G := A_below_g).
  destruct (step32_add _ _ _ _ C) as (o & h & Co & Ch & S). apply given32_is in Ch. subst h. fold g in S.
  apply (near_at_size x caps gaps L (line tiny tiny)) in Co;
    [ | exact l0 | vm_compute; reflexivity | unfold within in *; within_sizes ].
  unfold line in Co. cbn [at_size] in Co. rewrite tiny_is in Co. clear ax ay az. assert (h := h32_below). simpl in h.
    assert (A := alpha_below 3 ltac:(lia)). simpl INR in A. cbn -[u32 alpha] in Co. fold a_x a_y a_z in Co.
  assert (P := sum_below _ _ _ L l0 O_x_in O_y_in O_z_in).
  match type of Co with _ <= _ * ?p + _ => replace p with (Rabs a_x * Rabs (x O_x) + (Rabs a_y * Rabs (x O_y) + Rabs
    a_z *
    Rabs (x O_z))) in Co by ring end.
  assert (P0 : 0 <= Rabs a_x * Rabs (x O_x) + (Rabs a_y * Rabs (x O_y) + Rabs a_z * Rabs (x O_z))).
  { repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos. }
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 3) P0 A P).
  assert (R : Rabs (along (x O_x) (x O_y) (x O_z)) <= 1733 / 1000 * L).
  { eapply Rle_trans; [| exact P]. unfold along. eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_mult.
    apply Rplus_le_compat_l. eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult. lra. }
  unfold along in *. apply between in Co, N, g_is, R.
  assert (T : Rabs (o + g) <= 521 / 100 * L + 3 * tiny') by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ S) in T.
    apply between in T. lra.
Qed.

(* A point of the box. *)
Variables P_x P_y P_z : R.
Let inside i p j := x i <= p <= x j.
Hypotheses (P_x_in : inside low_x P_x high_x) (P_y_in : inside low_y P_y high_y) (P_z_in : inside low_z P_z high_z).
Hypotheses (r_in : 0 <= x rounding <= L + 1).
Lemma side_below a i p j : inside i p j -> a * (/ 2 * (x j + x i)) - Rabs a * (/ 2 * (x j - x i)) <= a * p.
Proof.
  unfold inside. intros H. destruct (Rle_dec 0 a).
  - rewrite (Rabs_pos_eq a) by lra. assert (G := Rmult_le_compat_l a (x i) p ltac:(lra) ltac:(lra)). lra.
  - rewrite (Rabs_left1 a) by lra. assert (G := Rmult_le_compat_l (- a) p (x j) ltac:(lra) ltac:(lra)). lra.
Qed.
Theorem box_near b : computed x box_low b -> b <= along P_x P_y P_z - x rounding + 245 / 10 * u * L + 8 * u * x
  rounding + 2 * tiny'.
Proof.
  intros C. assert (l0 := L0). destruct axes_in as (ax & ay & az). unfold a_x, a_y, a_z in ax, ay, az.
  apply (near_at_size x caps gaps L (line tiny tiny)) in C;
    [ | exact l0 | vm_compute; reflexivity
    | assert (d := difference_below); unfold within in *; within_sizes; try (rewrite Rabs_pos_eq; lra);
      try (rewrite ?same_x, ?same_y, ?same_z; unfold a_x, a_y, a_z; lra);
      try (eapply Rle_trans; [now apply d | lra]) ].
  unfold line in C. cbn [at_size] in C. rewrite tiny_is in C. clear ax ay az. assert (A := alpha_below 7 ltac:(lia)).
    simpl INR in A.
  cbn -[u32 alpha Q2R] in C. rewrite same_x, same_y, same_z in C.
  rewrite !(Rabs_pos_eq (Q2R _)) in C by (unfold Q2R; simpl; lra).
  replace (Q2R (1 # 2)) with (/ 2) in C by (unfold Q2R; simpl; lra). rewrite (Rabs_pos_eq (x rounding)) in C by lra.
  assert (S1 := side_below a_x _ _ _ P_x_in). assert (S2 := side_below a_y _ _ _ P_y_in).
  assert (S3 := side_below a_z _ _ _ P_z_in).
  assert (sum2 : forall i j, within i -> within j -> / 2 * (Rabs (x j) + Rabs (x i)) <= L) by (unfold within; intros;
    lra).
  assert (dif2 : forall i j, within i -> within j -> / 2 * Rabs (x j - x i) <= L).
  { intros i j Hi Hj. assert (D := difference_below _ _ Hj Hi). lra. }
  assert (Q1 := sum_below _ _ _ L l0 (sum2 _ _ l_x_in h_x_in) (sum2 _ _ l_y_in h_y_in) (sum2 _ _ l_z_in h_z_in)).
  assert (Q2 := sum_below _ _ _ L l0 (dif2 _ _ l_x_in h_x_in) (dif2 _ _ l_y_in h_y_in) (dif2 _ _ l_z_in h_z_in)).
  match type of C with _ <= _ * ?p + _ => set (P := p) in * end.
  assert (P1 : P <= 1733 / 1000 * (2 * L) + x rounding) by (unfold P; lra).
  assert (P0 : 0 <= P).
  { unfold P. repeat apply Rplus_le_le_0_compat; try lra; apply Rmult_le_pos; try apply Rabs_pos;
      apply Rmult_le_pos; try lra; try apply Rplus_le_le_0_compat; apply Rabs_pos. }
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 7) P0 A P1). apply between in C. unfold along. lra.
Qed.

Definition least_factor : Q := 53 # 16777216.
Theorem outside_is_outside t b c : computed x triangle_high t -> computed x box_low b -> Q2R least_factor <= Q2R c ->
  9999 / 10000 * (Q2R c * L + / 1000000000000000000000000000000) <= x rounding -> t < b -> along (x A_x) (x A_y) (x
    A_z) + 4 * u * L < along P_x P_y P_z.
Proof.
  intros Ct Cb Hc Hr H. assert (T := triangle_near _ Ct). assert (B := box_near _ Cb). assert (l0 := L0).
  replace (Q2R least_factor) with (53 * u) in Hc by (unfold Q2R, least_factor; simpl; lra).
  assert (G := Rmult_le_compat_r L _ _ l0 Hc). lra.
Qed.
End Axis.
Definition kernels_factor : Q := match factor with Const c => c | _ => 0%Q end.
Definition kernels_rest : Q := match of_nothing with Const c => c | _ => 0%Q end.
Lemma kernel_is_enough : (least_factor <= kernels_factor /\ 1 # 10 ^ 30 <= kernels_rest)%Q.
Proof. vm_compute. split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_factor kernels_factor.
Print constants.
Definition checked := (corner_near, triangle_near, box_near, outside_is_outside, kernel_is_enough).
Print Assumptions checked.
