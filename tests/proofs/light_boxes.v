(* SPDX-License-Identifier: MIT *)
(* beam_intersect.clh, point lights: the values of a triangle's edge and of its plane, h = n . (S - A), against one
   bound, which a box of lights multiplies with CONE_BOUNDS (docs/numerics.md, 16).
     bound_is_large        the computed bound is more than 8.6 u reach |A - P|_1 |B - A|_1;
     scale_is_small        the plane's scale times PLANE_BOUNDS BEAM_BOUND |n| (|A - P|_1 + 3 reach) is about the
        bound;
     edge_near, edge_of_box_near, plane_near, plane_of_box_near   so each value is off by at most the bound.

   Assumed: D = S - P has no coordinate above `reach`, but for 6 u of it; for the box, whose part may stick out of
   the whole box, the coordinates of the four vectors add up to at most 3 reach (geometry: the lights of a part lie
   in the whole box); a quotient is off by 2.5 ulp; no input but the scale exceeds 2^24. Denormals may be kept or
   flushed: BEAM_UNDERFLOW covers what that takes. A greater of two is at least both, or 2^-126 less where it
   flushes one. Overflow: nothing exceeds 2^60. *)
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
Definition P_x := 9%nat.
Definition P_y := 10%nat.
Definition P_z := 11%nat.
Definition S_x := 12%nat.
Definition S_y := 13%nat.
Definition S_z := 14%nat.
Definition reach := 15%nat.
Definition box_1_0 := 16%nat.
Definition box_1_1 := 17%nat.
Definition box_1_2 := 18%nat.
Definition box_2_0 := 19%nat.
Definition box_2_1 := 20%nat.
Definition box_2_2 := 21%nat.
Definition box_3_0 := 22%nat.
Definition box_3_1 := 23%nat.
Definition box_3_2 := 24%nat.
Definition box_0_0_0 := 25%nat.
Definition box_0_0_1 := 26%nat.
Definition box_0_0_2 := 27%nat.
Definition greater_1 := 28%nat.
Definition greater_2 := 29%nat.
Definition greater_3 := 30%nat.
Definition greater_4 := 31%nat.
Definition greater_5 := 32%nat.
Definition greater_6 := 33%nat.
Definition quotient_1 := 34%nat.
Definition greater_1_one :=
  Const (1 # 1).
Definition greater_1_other := Given reach 0.
Definition greater_2_one :=
  Add (Abs (Diff A_z P_z)) (Add (Abs (Diff A_x P_x)) (Abs (Diff A_y P_y))).
Definition greater_2_other :=
  Add (Abs (Diff B_z P_z)) (Add (Abs (Diff B_x P_x)) (Abs (Diff B_y P_y))).
Definition greater_3_one :=
  Add (Abs (Diff B_z A_z)) (Add (Abs (Diff B_x A_x)) (Abs (Diff B_y A_y))).
Definition greater_3_other :=
  Add (Abs (Diff C_z B_z)) (Add (Abs (Diff C_x B_x)) (Abs (Diff C_y B_y))).
Definition greater_4_one :=
  Add (Abs (Diff A_z C_z)) (Add (Abs (Diff A_x C_x)) (Abs (Diff A_y C_y))).
Definition greater_4_other := Given greater_3 0.
Definition bound :=
  Add (Times (1 # 18446744073709551616) (Given greater_1 0)) (Mul (Given reach 0) (Mul (Given greater_2 0) (Times
    (9147937 # 17592186044416) (Given greater_4 0)))).
Definition edge :=
  Fma (Fma (Diff A_y P_y) (Diff B_z A_z) (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Diff S_x P_x) (Fma (Fma (Diff
    A_z P_z) (Diff B_x A_x) (Mul (Neg (Diff A_x P_x)) (Diff B_z A_z))) (Diff S_y P_y) (Mul (Fma (Diff A_x P_x) (Diff
    B_y A_y) (Mul (Neg (Diff A_y P_y)) (Diff B_x A_x))) (Diff S_z P_z))).
Definition edge_of_box :=
  Sub (Fma (Fma (Diff A_y P_y) (Diff B_z A_z) (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Diff box_1_0 P_x) (Fma
    (Fma (Diff A_z P_z) (Diff B_x A_x) (Mul (Neg (Diff A_x P_x)) (Diff B_z A_z))) (Diff box_1_1 P_y) (Mul (Fma (Diff
    A_x P_x) (Diff B_y A_y) (Mul (Neg (Diff A_y P_y)) (Diff B_x A_x))) (Diff box_1_2 P_z)))) (Add (Abs (Fma (Fma
    (Diff A_y P_y) (Diff B_z A_z) (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Given box_0_0_0 0) (Fma (Fma (Diff A_z
    P_z) (Diff B_x A_x) (Mul (Neg (Diff A_x P_x)) (Diff B_z A_z))) (Given box_0_0_1 0) (Mul (Fma (Diff A_x P_x)
    (Diff B_y A_y) (Mul (Neg (Diff A_y P_y)) (Diff B_x A_x))) (Given box_0_0_2 0))))) (Add (Abs (Fma (Fma (Diff A_y
    P_y) (Diff B_z A_z) (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Given box_2_0 0) (Fma (Fma (Diff A_z P_z) (Diff
    B_x A_x) (Mul (Neg (Diff A_x P_x)) (Diff B_z A_z))) (Given box_2_1 0) (Mul (Fma (Diff A_x P_x) (Diff B_y A_y)
    (Mul (Neg (Diff A_y P_y)) (Diff B_x A_x))) (Given box_2_2 0))))) (Abs (Fma (Fma (Diff A_y P_y) (Diff B_z A_z)
    (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Given box_3_0 0) (Fma (Fma (Diff A_z P_z) (Diff B_x A_x) (Mul (Neg
    (Diff A_x P_x)) (Diff B_z A_z))) (Given box_3_1 0) (Mul (Fma (Diff A_x P_x) (Diff B_y A_y) (Mul (Neg (Diff A_y
    P_y)) (Diff B_x A_x))) (Given box_3_2 0))))))).
Definition greater_5_one :=
  Add (Abs (Mul (Diff A_x C_x) (Diff B_z A_z))) (Abs (Mul (Diff A_z C_z) (Diff B_x A_x))).
Definition greater_5_other :=
  Add (Abs (Mul (Diff A_y C_y) (Diff B_z A_z))) (Abs (Mul (Diff A_z C_z) (Diff B_y A_y))).
Definition greater_6_one :=
  Add (Abs (Mul (Diff A_x C_x) (Diff B_y A_y))) (Abs (Mul (Diff A_y C_y) (Diff B_x A_x))).
Definition greater_6_other := Given greater_5 0.
Definition quotient_1_over :=
  bound.
Definition quotient_1_under :=
  Add (Const (1 # 18446744073709551616)) (Mul (Times (3 # 2) (Add greater_2_one (Times (3 # 1) (Given reach 0))))
    (Times (9147937 # 17592186044416) (Given greater_6 0))).
Definition plane :=
  Sub (Fma (Mul (Given quotient_1 0) (Sub (Mul (Diff A_y C_y) (Diff B_z A_z)) (Mul (Diff A_z C_z) (Diff B_y A_y))))
    (Diff S_x P_x) (Fma (Mul (Given quotient_1 0) (Sub (Mul (Diff A_z C_z) (Diff B_x A_x)) (Mul (Diff A_x C_x) (Diff
    B_z A_z)))) (Diff S_y P_y) (Mul (Mul (Given quotient_1 0) (Sub (Mul (Diff A_x C_x) (Diff B_y A_y)) (Mul (Diff
    A_y C_y) (Diff B_x A_x)))) (Diff S_z P_z)))) (Mul (Abs (Fma (Diff A_x P_x) (Sub (Mul (Diff A_y C_y) (Diff B_z
    A_z)) (Mul (Diff A_z C_z) (Diff B_y A_y))) (Fma (Diff A_y P_y) (Sub (Mul (Diff A_z C_z) (Diff B_x A_x)) (Mul
    (Diff A_x C_x) (Diff B_z A_z))) (Mul (Diff A_z P_z) (Sub (Mul (Diff A_x C_x) (Diff B_y A_y)) (Mul (Diff A_y C_y)
    (Diff B_x A_x))))))) (Given quotient_1 0)).
Definition plane_of_box :=
  Sub (Sub (Fma (Mul (Given quotient_1 0) (Sub (Mul (Diff A_y C_y) (Diff B_z A_z)) (Mul (Diff A_z C_z) (Diff B_y
    A_y)))) (Diff box_1_0 P_x) (Fma (Mul (Given quotient_1 0) (Sub (Mul (Diff A_z C_z) (Diff B_x A_x)) (Mul (Diff
    A_x C_x) (Diff B_z A_z)))) (Diff box_1_1 P_y) (Mul (Mul (Given quotient_1 0) (Sub (Mul (Diff A_x C_x) (Diff B_y
    A_y)) (Mul (Diff A_y C_y) (Diff B_x A_x)))) (Diff box_1_2 P_z)))) (Mul (Abs (Fma (Diff A_x P_x) (Sub (Mul (Diff
    A_y C_y) (Diff B_z A_z)) (Mul (Diff A_z C_z) (Diff B_y A_y))) (Fma (Diff A_y P_y) (Sub (Mul (Diff A_z C_z) (Diff
    B_x A_x)) (Mul (Diff A_x C_x) (Diff B_z A_z))) (Mul (Diff A_z P_z) (Sub (Mul (Diff A_x C_x) (Diff B_y A_y)) (Mul
    (Diff A_y C_y) (Diff B_x A_x))))))) (Given quotient_1 0))) (Add (Abs (Fma (Given box_0_0_0 0) (Mul (Given
    quotient_1 0) (Sub (Mul (Diff A_y C_y) (Diff B_z A_z)) (Mul (Diff A_z C_z) (Diff B_y A_y)))) (Fma (Given
    box_0_0_1 0) (Mul (Given quotient_1 0) (Sub (Mul (Diff A_z C_z) (Diff B_x A_x)) (Mul (Diff A_x C_x) (Diff B_z
    A_z)))) (Mul (Given box_0_0_2 0) (Mul (Given quotient_1 0) (Sub (Mul (Diff A_x C_x) (Diff B_y A_y)) (Mul (Diff
    A_y C_y) (Diff B_x A_x)))))))) (Add (Abs (Fma (Given box_2_0 0) (Mul (Given quotient_1 0) (Sub (Mul (Diff A_y
    C_y) (Diff B_z A_z)) (Mul (Diff A_z C_z) (Diff B_y A_y)))) (Fma (Given box_2_1 0) (Mul (Given quotient_1 0) (Sub
    (Mul (Diff A_z C_z) (Diff B_x A_x)) (Mul (Diff A_x C_x) (Diff B_z A_z)))) (Mul (Given box_2_2 0) (Mul (Given
    quotient_1 0) (Sub (Mul (Diff A_x C_x) (Diff B_y A_y)) (Mul (Diff A_y C_y) (Diff B_x A_x)))))))) (Abs (Fma
    (Given box_3_0 0) (Mul (Given quotient_1 0) (Sub (Mul (Diff A_y C_y) (Diff B_z A_z)) (Mul (Diff A_z C_z) (Diff
    B_y A_y)))) (Fma (Given box_3_1 0) (Mul (Given quotient_1 0) (Sub (Mul (Diff A_z C_z) (Diff B_x A_x)) (Mul (Diff
    A_x C_x) (Diff B_z A_z)))) (Mul (Given box_3_2 0) (Mul (Given quotient_1 0) (Sub (Mul (Diff A_x C_x) (Diff B_y
    A_y)) (Mul (Diff A_y C_y) (Diff B_x A_x)))))))))).
(* bound_of_box = bound_of_box_constant * quotient_1_over *)
Definition bound_of_box_constant : Q := 4 # 1.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation computed := (limited32 (2 ^ 24)).
Definition of_sizes : Q := 1 # 1329227995784915872903807060280344576.  (* 2^-120 *)
Local Notation of_sizes' := (/ 1329227995784915872903807060280344576).
Definition rest : Q := 1 # 295147905179352825856.  (* 2^-68 *)
Local Notation rest' := (/ 295147905179352825856).
Lemma rests_are : Q2R of_sizes = of_sizes' /\ Q2R rest = rest'.
Proof. unfold Q2R, of_sizes, rest; simpl; lra. Qed.
Ltac rest_in C := destruct rests_are as [of_sizes_is rest_is]; rewrite ?of_sizes_is, ?rest_is in C; clear of_sizes_is
  rest_is.
Local Notation least := (/ 36893488147419103232).  (* 2^-65, half of BEAM_UNDERFLOW *)
Definition of_edge : Q := match bound with Add _ (Mul _ (Mul _ (Times c _))) => c | _ => 0%Q end.
Definition of_plane : Q * Q := match quotient_1_under with
  Add _ (Mul (Times p (Add a (Times t _))) (Times c _)) => (p, c) | _ => (0%Q, 0%Q) end.

Lemma cross_total a b c d e f : 0 <= a -> 0 <= b -> 0 <= c -> 0 <= d -> 0 <= e -> 0 <= f ->
  (b * f + c * e) + (c * d + a * f) + (a * e + b * d) <= (a + b + c) * (d + e + f).
Proof.
  intros. assert (0 <= a * d) by (apply Rmult_le_pos; lra). assert (0 <= b * e) by (apply Rmult_le_pos; lra).
  assert (0 <= c * f) by (apply Rmult_le_pos; lra). lra.
Qed.
Lemma dot_below l m n d e f r : 0 <= l -> 0 <= m -> 0 <= n -> d <= r -> e <= r -> f <= r ->
  l * d + (m * e + n * f) <= (l + m + n) * r.
Proof.
  intros. assert (l * d <= l * r) by (apply Rmult_le_compat_l; lra).
  assert (m * e <= m * r) by (apply Rmult_le_compat_l; lra).
  assert (n * f <= n * r) by (apply Rmult_le_compat_l; lra). lra.
Qed.

Section Lights.
Variable x : nat -> R.
Let size i j k l m n := Rabs (x i - x j) + Rabs (x k - x l) + Rabs (x m - x n).
Let a := size A_x P_x A_y P_y A_z P_z.
Let f := size B_x A_x B_y A_y B_z A_z.
Let reach' := x reach.
Hypothesis reach0 : 0 <= reach'.
Lemma size0 i j k l m n : 0 <= size i j k l m n.
Proof. unfold size. repeat apply Rplus_le_le_0_compat; apply Rabs_pos. Qed.

(* ---- The bound ---- *)
Lemma size_near i j k l m n v :
  computed x (Add (Abs (Diff m n)) (Add (Abs (Diff i j)) (Abs (Diff k l)))) v -> (1 - 301 / 100 * u) * size i j k l m
    n - of_sizes' <= v.
Proof.
  intros C. near_in (2 ^ 24)%Q of_sizes (Add (Abs (Diff m n)) (Add (Abs (Diff i j)) (Abs (Diff k l)))) C. rest_in C.
    assert (A := alpha_below 3 ltac:(lia)). simpl INR in A. cbn -[u32 alpha] in C.
  assert (S := size0 i j k l m n). unfold size in *.
  assert (E := Rmult_le_compat_r _ _ _ S A). apply between in C. lra.
Qed.

(* a' and f' are the sizes as they are computed: one of the results that their expressions may have. *)
Variables a' f' : R.
Hypotheses (a_is : a' <= x greater_2 + h32) (f_is : f' <= x greater_4 + h32).
Hypotheses (greater_2_0 : 0 <= x greater_2 ) (greater_4_0 : 0 <= x greater_4).
Hypotheses (greater_2_in : x greater_2 <= 67108864) (greater_4_in : x greater_4 <= 67108864).
Hypotheses (a_computed : computed x greater_2_one a') (f_computed : computed x greater_3_one f').
Hypotheses (one : 1 <= x greater_1) (reach_in : reach' <= 16777216) (a_in : a <= 67108864) (f_in : f <= 67108864).
Theorem bound_is_large b : computed x bound b -> 86 / 10 * u * (a * f * reach') + least <= b.
Proof.
  intros C. near_in (2 ^ 24)%Q rest bound C. rest_in C. assert (A := alpha_below 4 ltac:(lia)). simpl INR in A.
  assert (Sa := size_near _ _ _ _ _ _ _ a_computed). assert (Sf := size_near _ _ _ _ _ _ _ f_computed).
  assert (Ga := a_is). assert (Gf := f_is). assert (l := h32_below). simpl in l. fold a in Sa. fold f in Sf.
  assert (a0 : 0 <= a) by apply size0. assert (f0 : 0 <= f) by apply size0.
  assert (af : 0 <= a * f) by (apply Rmult_le_pos; lra).
  assert (P : (1 - 301 / 100 * u) * a * ((1 - 301 / 100 * u) * f) - of_sizes' * 150000000 <= x greater_2 * x greater_4).
  { assert (G1 := Rmult_le_compat_r (x greater_4 + 11 / 10 * of_sizes') ((1 - 301 / 100 * u) * a) (x greater_2 + 11 / 10 * of_sizes')
    ltac:(lra) ltac:(lra)).
    assert (G2 := Rmult_le_compat_l ((1 - 301 / 100 * u) * a) ((1 - 301 / 100 * u) * f) (x greater_4 + 11 / 10 * of_sizes')
      ltac:(lra) ltac:(lra)). lra. }
  assert (Q := Rmult_le_compat_r reach' _ _ reach0 P).
  unfold bound in C. cbn -[u32 alpha Q2R] in C. fold reach' in C.
  rewrite !(Rabs_pos_eq (Q2R _)) in C by (unfold Q2R; simpl; lra).
  rewrite (Rabs_pos_eq reach'), (Rabs_pos_eq (x greater_2)), (Rabs_pos_eq (x greater_4)), (Rabs_pos_eq (x greater_1)) in
    C by lra.
  set (T := Q2R (1 # 18446744073709551616) * x greater_1) in *.
  assert (T0 : / 18446744073709551616 <= T).
  { unfold T. replace (Q2R (1 # 18446744073709551616)) with (/ 18446744073709551616) by (unfold Q2R; simpl; lra). lra. }
  replace (Q2R (9147937 # 17592186044416)) with (9147937 / 17592186044416) in C by (unfold Q2R; simpl; lra).
  assert (W0 : 0 <= a * f * reach') by (repeat apply Rmult_le_pos; lra).
  assert (afr := Rmult_le_compat_l (a * f) _ _ af reach_in). assert (r_in := reach_in).
  set (W := x greater_2 * x greater_4 * reach') in *.
  assert (S0 : 0 <= T + 9147937 / 17592186044416 * W) by lra.
  assert (E := Rmult_le_compat_r _ _ _ S0 A). unfold W in E at 1. apply between in C. unfold W in *. lra.
Qed.

(* ---- Edges ---- *)
Let N_x := Rabs (x A_y - x P_y) * Rabs (x B_z - x A_z) + Rabs (x A_z - x P_z) * Rabs (x B_y - x A_y).
Let N_y := Rabs (x A_z - x P_z) * Rabs (x B_x - x A_x) + Rabs (x A_x - x P_x) * Rabs (x B_z - x A_z).
Let N_z := Rabs (x A_x - x P_x) * Rabs (x B_y - x A_y) + Rabs (x A_y - x P_y) * Rabs (x B_x - x A_x).
Lemma N_below r l m n : 0 <= r -> l <= r -> m <= r -> n <= r -> N_x * l + (N_y * m + N_z * n) <= a * f * r.
Proof.
  intros. assert (Z : forall i j k l, 0 <= Rabs (x i - x j) * Rabs (x k - x l)) by (intros; apply Rmult_le_pos; apply
    Rabs_pos).
  eapply Rle_trans; [apply dot_below with (r := r); auto; apply Rplus_le_le_0_compat; apply Z |].
  apply Rmult_le_compat_r; [assumption |]. apply cross_total; apply Rabs_pos.
Qed.

Let one_light r := Rabs (x S_x - x P_x) <= r /\ Rabs (x S_y - x P_y) <= r /\ Rabs (x S_z - x P_z) <= r.
Let of_box i l m n j := Rabs (x i - x j) + (Rabs (x l) + (Rabs (x m) + Rabs (x n))).
Let box r := of_box box_1_0 box_0_0_0 box_2_0 box_3_0 P_x <= r /\ of_box box_1_1 box_0_0_1 box_2_1 box_3_1 P_y <= r /\
  of_box box_1_2 box_0_0_2 box_2_2 box_3_2 P_z <= r.

Theorem edge_near v b : one_light ((1 + 6 * u) * reach') -> computed x edge v -> computed x bound b ->
  Rabs (v - real x edge) <= b.
Proof.
  intros (L1 & L2 & L3) C Cb. apply bound_is_large in Cb. near_in (2 ^ 24)%Q rest edge C. rest_in C. eapply Rle_trans;
    [exact C | clear C].
  assert (A := alpha_below 8 ltac:(lia)). simpl INR in A.
  assert (G := N_below ((1 + 6 * u) * reach') _ _ _ ltac:(lra) L1 L2 L3). change (roundings edge) with 8%nat.
  assert (P : permanent x edge <= a * f * ((1 + 6 * u) * reach')) by (unfold N_x, N_y, N_z in G; cbn; lra).
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 8) (permanent_positive x edge) A P).
  assert (W0 : 0 <= a * f * reach') by (repeat apply Rmult_le_pos; auto; apply size0). lra.
Qed.

(* From this factor on. *)
Definition least_times : Q := 349 # 100.
Theorem edge_of_box_near v b : box (3 * reach') -> computed x edge_of_box v -> computed x bound b ->
  Rabs (v - real x edge_of_box) <= Q2R least_times * b.
Proof.
  intros (L1 & L2 & L3) C Cb. apply bound_is_large in Cb. near_in (2 ^ 24)%Q rest edge_of_box C. rest_in C. eapply
    Rle_trans; [exact C | clear C].
  assert (A := alpha_below 10 ltac:(lia)). simpl INR in A.
  replace (Q2R least_times) with (349 / 100) by (unfold Q2R, least_times; simpl; lra).
  assert (G := N_below (3 * reach') _ _ _ ltac:(lra) L1 L2 L3). change (roundings edge_of_box) with 10%nat.
  assert (P : permanent x edge_of_box <= a * f * (3 * reach')) by (unfold N_x, N_y, N_z, of_box in G; cbn; lra).
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 10) (permanent_positive x edge_of_box) A P).
  assert (W0 : 0 <= a * f * reach') by (repeat apply Rmult_le_pos; auto; apply size0). lra.
Qed.

(* ---- The plane ---- *)
Let M_x := Rabs (x A_y - x C_y) * Rabs (x B_z - x A_z) + Rabs (x A_z - x C_z) * Rabs (x B_y - x A_y).
Let M_y := Rabs (x A_z - x C_z) * Rabs (x B_x - x A_x) + Rabs (x A_x - x C_x) * Rabs (x B_z - x A_z).
Let M_z := Rabs (x A_x - x C_x) * Rabs (x B_y - x A_y) + Rabs (x A_y - x C_y) * Rabs (x B_x - x A_x).
Lemma M0 : 0 <= M_x /\ 0 <= M_y /\ 0 <= M_z.
Proof. repeat split; apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos. Qed.
(* The greatest of the normal's sizes, of which greater_6 is the computed one: 4 roundings. *)
Variable n : R.
Hypotheses (M_x_in : M_x <= n) (M_y_in : M_y <= n) (M_z_in : M_z <= n).
(* Underflow takes less than 2^-90 of it; the scale's least term, 2^-64, has room for that. *)
Hypotheses (n_is : (1 - 401 / 100 * u) * n - / 2 ^ 90 <= x greater_6) (greater_6_0 : 0 <= x greater_6).
Let q := x quotient_1.
Hypothesis q0 : 0 <= q.
(* What PLANE_BOUNDS BEAM_BOUND is multiplied with, times the scale. *)
Let X := q * (n * (a + 3 * reach')).
Lemma n0 : 0 <= n.
Proof. destruct M0. lra. Qed.
Lemma X0 : 0 <= X.
Proof. unfold X. assert (A := size0 A_x P_x A_y P_y A_z P_z). fold a in A. repeat apply Rmult_le_pos; auto using n0;
  lra.
Qed.

Theorem scale_is_small b w : computed x quotient_1_under w -> q * w <= (1 + 6 * u) * b -> 0 < w ->
  130 / 10 * u * X + least * q <= b.
Proof.
  intros C Q w0. assert (Sa : size A_x P_x A_y P_y A_z P_z = a) by reflexivity.
  near_in (2 ^ 24)%Q rest quotient_1_under C. rest_in C. assert (A := alpha_below 8 ltac:(lia)). simpl INR in A.
    assert (A8 := alpha_at_least 8).
  unfold quotient_1_under, greater_2_one in C. cbn -[u32 alpha Q2R] in C. fold reach' in C.
  rewrite !(Rabs_pos_eq (Q2R _)) in C by (unfold Q2R; simpl; lra).
  rewrite (Rabs_pos_eq reach') in C by lra. assert (a0 : 0 <= a) by apply size0. assert (n0 := n0).
  assert (g0 := greater_6_0). rewrite (Rabs_pos_eq (x greater_6)) in C by lra.
  replace (Rabs (x A_z - x P_z) + (Rabs (x A_x - x P_x) + Rabs (x A_y - x P_y))) with a in C by (unfold a, size; ring).
  replace (Q2R (3 # 2)) with (3 / 2) in C by (unfold Q2R; simpl; lra).
  replace (Q2R (3 # 1)) with 3 in C by (unfold Q2R; simpl; lra).
  replace (Q2R (9147937 # 17592186044416)) with (9147937 / 17592186044416) in C by (unfold Q2R; simpl; lra).
  set (T := Q2R (1 # 18446744073709551616)) in *. assert (T0 : T = / 18446744073709551616) by (unfold T, Q2R; simpl;
    lra).
  set (Y := (a + 3 * reach') * x greater_6). assert (Y0 : 0 <= Y) by (apply Rmult_le_pos; lra).
  assert (Y1 : (1 - 401 / 100 * u) * (n * (a + 3 * reach')) - / 2 ^ 62 <= Y).
  { unfold Y. assert (G := Rmult_le_compat_r (a + 3 * reach') _ _ ltac:(lra) n_is).
    assert (a + 3 * reach' <= 2 ^ 28) by (simpl; lra).
    simpl in *. lra. }
  replace (3 / 2 * (a + 3 * reach') * (9147937 / 17592186044416 * x greater_6)) with (3 / 2 * (9147937 / 17592186044416)
    * Y) in C
    by (unfold Y; ring).
  assert (E := Rmult_le_compat_r (T + 3 / 2 * (9147937 / 17592186044416) * Y) _ _ ltac:(lra) A).
  apply between in C. assert (W : (1 - 81 / 10 * u) * (3 / 2 * (9147937 / 17592186044416) * Y) + 9 / 10 * T <= w) by
    lra.
  rewrite T0 in W. assert (G := Rmult_le_compat_l q _ _ q0 W). assert (H := Rmult_le_compat_l q _ _ q0 Y1). unfold X.
  assert (Z := X0). unfold X in Z. lra.
Qed.

Lemma M_below l m o : 0 <= l -> 0 <= m -> 0 <= o -> l * M_x + (m * M_y + o * M_z) <= n * (l + m + o).
Proof.
  intros. assert (l * M_x <= l * n) by (apply Rmult_le_compat_l; lra).
  assert (m * M_y <= m * n) by (apply Rmult_le_compat_l; lra).
  assert (o * M_z <= o * n) by (apply Rmult_le_compat_l; lra). lra.
Qed.

(* The scale is no denormal, being 2^-64 or more by 2^56 or less; no other input exceeds 2^24. *)
Hypothesis q_is_normal : 2 * h32 <= q.
Let may_lose i := if Nat.eqb i quotient_1 then 0%Q else h32Q.
Lemma q_keeps : keeps x may_lose.
Proof.
  intros i. unfold may_lose. destruct (Nat.eqb_spec i quotient_1); [right | now left]. subst i. split; [reflexivity |
    right].
  fold q. now rewrite Rabs_pos_eq.
Qed.
Let caps i := if Nat.eqb i quotient_1 then line 0 1 else number (2 ^ 24).
Let gaps (i j : nat) := number (2 ^ 24).
Definition limited_plane e v := computes32 x e v /\ within x (fun i => at_size q (caps i)) (fun i j => at_size q (gaps
  i j)) e.

Theorem plane_near v b w : one_light ((1 + 6 * u) * reach') -> computed x quotient_1_under w -> q * w <= (1 + 6 * u) * b
  -> 0 < w -> computed x bound b -> limited_plane plane v -> Rabs (v - real x plane) <= b.
Proof.
  intros (L1 & L2 & L3) Cw Hq w0 Cb [C W]. assert (B := scale_is_small _ _ Cw Hq w0). apply bound_is_large in Cb.
  apply (near_at_size_keeping x may_lose caps gaps q (line rest rest)) in C; [| exact q_keeps | exact q0 | vm_compute;
    reflexivity | exact W].
  unfold line in C. cbn [at_size] in C. rest_in C. eapply Rle_trans; [exact C | clear C W]. assert (A := alpha_below
    10 ltac:(lia)). simpl INR in A.
  change (roundings plane) with 10%nat.
  assert (G := M_below _ _ _ (Rabs_pos (x S_x - x P_x)) (Rabs_pos (x S_y - x P_y)) (Rabs_pos (x S_z - x P_z))).
  assert (H := M_below _ _ _ (Rabs_pos (x A_x - x P_x)) (Rabs_pos (x A_y - x P_y)) (Rabs_pos (x A_z - x P_z))).
  fold (size A_x P_x A_y P_y A_z P_z) in H. fold a in H. assert (n0 := n0).
  assert (D : n * (Rabs (x S_x - x P_x) + Rabs (x S_y - x P_y) + Rabs (x S_z - x P_z)) <= n * (3 * ((1 + 6 * u) *
    reach'))).
  { apply Rmult_le_compat_l; lra. }
  assert (a0 : 0 <= a) by apply size0. assert (na : 0 <= n * a) by (apply Rmult_le_pos; lra).
  assert (P : permanent x plane <= (1 + 6 * u) * X).
  { unfold plane; cbn; fold q; rewrite (Rabs_pos_eq q) by assumption.
    set (D_x := Rabs (x S_x - x P_x)) in *. set (D_y := Rabs (x S_y - x P_y)) in *. set (D_z := Rabs (x S_z - x P_z))
      in *.
    set (a_x := Rabs (x A_x - x P_x)) in *. set (a_y := Rabs (x A_y - x P_y)) in *. set (a_z := Rabs (x A_z - x P_z))
      in *.
    assert (Q := Rmult_le_compat_l q _ _ q0 (Rplus_le_compat _ _ _ _ (Rle_trans _ _ _ G D) H)).
    assert (qna := Rmult_le_pos _ _ q0 na). unfold X, M_x, M_y, M_z in *. lra. }
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 10) (permanent_positive x plane) A P). assert (Z := X0).
  assert (afr : 0 <= a * f * reach') by (repeat apply Rmult_le_pos; auto; apply size0). lra.
Qed.

Theorem plane_of_box_near v b w : box (3 * reach') -> computed x quotient_1_under w -> q * w <= (1 + 6 * u) * b -> 0 <
  w ->
  computed x bound b -> limited_plane plane_of_box v -> Rabs (v - real x plane_of_box) <= Q2R least_times * b.
Proof.
  intros (L1 & L2 & L3) Cw Hq w0 Cb [C W]. assert (B := scale_is_small _ _ Cw Hq w0). apply bound_is_large in Cb.
  apply (near_at_size_keeping x may_lose caps gaps q (line rest rest)) in C; [| exact q_keeps | exact q0 | vm_compute;
    reflexivity | exact W].
  unfold line in C. cbn [at_size] in C. rest_in C. eapply Rle_trans; [exact C | clear C W]. assert (A := alpha_below
    11 ltac:(lia)). simpl INR in A.
  replace (Q2R least_times) with (349 / 100) by (unfold Q2R, least_times; simpl; lra).
  change (roundings plane_of_box) with 11%nat. unfold of_box in L1, L2, L3.
  assert (G := fun i j k => M_below _ _ _ (Rabs_pos (x i)) (Rabs_pos (x j)) (Rabs_pos (x k))).
  assert (G0 := M_below _ _ _ (Rabs_pos (x box_1_0 - x P_x)) (Rabs_pos (x box_1_1 - x P_y)) (Rabs_pos (x box_1_2 - x
    P_z))).
  assert (G1 := G box_0_0_0 box_0_0_1 box_0_0_2). assert (G2 := G box_2_0 box_2_1 box_2_2).
  assert (G3 := G box_3_0 box_3_1 box_3_2). clear G.
  assert (H := M_below _ _ _ (Rabs_pos (x A_x - x P_x)) (Rabs_pos (x A_y - x P_y)) (Rabs_pos (x A_z - x P_z))).
  fold (size A_x P_x A_y P_y A_z P_z) in H. fold a in H. assert (n0 := n0).
  assert (D : n * (Rabs (x box_1_0 - x P_x) + Rabs (x box_1_1 - x P_y) + Rabs (x box_1_2 - x P_z) +
    (Rabs (x box_0_0_0) + Rabs (x box_0_0_1) + Rabs (x box_0_0_2)) + (Rabs (x box_2_0) + Rabs (x box_2_1) + Rabs (x
      box_2_2)) +
    (Rabs (x box_3_0) + Rabs (x box_3_1) + Rabs (x box_3_2))) <= n * (3 * (3 * reach'))).
  { apply Rmult_le_compat_l; lra. }
  assert (a0 : 0 <= a) by apply size0. assert (na : 0 <= n * a) by (apply Rmult_le_pos; lra).
  assert (P : permanent x plane_of_box <= 3 * X).
  { unfold plane_of_box; cbn; fold q; rewrite (Rabs_pos_eq q) by assumption.
    repeat match goal with |- context [Rabs (x ?i - x ?j)] => set (Rabs (x i - x j)) in * end.
    repeat match goal with |- context [Rabs (x ?i)] => set (Rabs (x i)) in * end.
    assert (S : forall l m, l <= m -> q * l <= q * m) by (intros; apply Rmult_le_compat_l; auto).
    assert (S0 := S _ _ G0). assert (S1 := S _ _ G1). assert (S2 := S _ _ G2). assert (S3 := S _ _ G3).
    assert (SH := S _ _ H). assert (SD := S _ _ D). assert (qna := Rmult_le_pos _ _ q0 na).
    unfold X, M_x, M_y, M_z in *. lra. }
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 11) (permanent_positive x plane_of_box) A P). assert (Z := X0).
  assert (afr : 0 <= a * f * reach') by (repeat apply Rmult_le_pos; auto; apply size0). lra.
Qed.
End Lights.

Definition least_plane : Q := 1001 # 1677721600.
Lemma kernels_are_enough : (
  bound_of_box_constant * (1 - u32Q) >= least_times /\ fst of_plane * snd of_plane * (1 - alphaQ u32Q 16) >=
    least_plane /\
  of_edge = snd of_plane)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_plane (Qred (fst of_plane * snd of_plane)).
Print constants.
Definition rests := Eval vm_compute in shown least_times bound_of_box_constant.
Print rests.
Definition checked := (bound_is_large, edge_near, edge_of_box_near, scale_is_small, plane_near, plane_of_box_near,
  kernels_are_enough).
Print Assumptions checked.
