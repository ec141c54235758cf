(* SPDX-License-Identifier: MIT *)
(* prepared_facing.clh: how far the eye is above a triangle's plane, n . eye - n . a, against 32 u (E + A).

   Assumed: no coordinate of the eye exceeds E, none of the triangle A; the sizes in n times the scale are at most
   1 + 2^-20 (1 as they are computed); the scale is at most 2^59 (sizes are PLANE_LEAST and more), the triangle's sides up to
   2^21 (they are usable only up to 2^20). Denormals may be kept or flushed: n loses less than 2^-40, and half of
   the bound's 2^-120 has the rest; the other half has what the bound itself loses. The bound rounds twice more than
   `size`. Overflow: the bound is infinite beyond 2^100. *)
From Coq Require Import Reals QArith Qreals Lia Lra Psatz.
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
Definition eye_x := 9%nat.
Definition eye_y := 10%nat.
Definition eye_z := 11%nat.
Definition scale := 12%nat.
Definition E := 13%nat.
Definition A := 14%nat.
Definition value :=
  Add (Add (Mul (Given eye_x 0) (Mul (Given scale 0) (Sub (Mul (Diff b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z)
    (Diff c_y a_y))))) (Mul (Given eye_y 0) (Mul (Given scale 0) (Sub (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff
    b_x a_x) (Diff c_z a_z)))))) (Sub (Mul (Given eye_z 0) (Mul (Given scale 0) (Sub (Mul (Diff b_x a_x) (Diff c_y
    a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x))))) (Add (Add (Mul (Given a_x 0) (Mul (Given scale 0) (Sub (Mul (Diff
    b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z) (Diff c_y a_y))))) (Mul (Given a_y 0) (Mul (Given scale 0) (Sub
    (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff b_x a_x) (Diff c_z a_z)))))) (Mul (Given a_z 0) (Mul (Given scale
    0) (Sub (Mul (Diff b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x))))))).
Definition plane_least :=
  Const (1 # 1152921504606846976).
Definition size :=
  Add (Abs (Given E 0)) (Given A 0).
(* bound: where size <= 1.2676506002282294e+30 *)
(* bound = bound_constant * size *)
Definition bound_constant : Q := 1 # 524288.
Definition bound_rest : Q := 1 # 1329227995784915872903807060280344576.
(* end: from the kernels *)

Section Plane.
Variable x : nat -> R.
Open Scope R_scope.
Hypotheses (eye_x_in : Rabs (x eye_x) <= x E) (eye_y_in : Rabs (x eye_y) <= x E) (eye_z_in : Rabs (x eye_z) <= x E).
Hypotheses (a_x_in : Rabs (x a_x) <= x A) (a_y_in : Rabs (x a_y) <= x A) (a_z_in : Rabs (x a_z) <= x A).
Let most := Q2R (1048577 # 1048576).
Let products_of i j k l m n o p :=
  (Rabs (x i - x j) * Rabs (x k - x l) + Rabs (x m - x n) * Rabs (x o - x p)) * Rabs (x scale).
Hypotheses (n_x_in : products_of b_y a_y c_z a_z b_z a_z c_y a_y <= most).
Hypotheses (n_y_in : products_of b_z a_z c_x a_x b_x a_x c_z a_z <= most).
Hypotheses (n_z_in : products_of b_x a_x c_y a_y b_y a_y c_x a_x <= most).

Lemma value_is_the_height :
  real x value = x scale *
    (((x b_y - x a_y) * (x c_z - x a_z) - (x b_z - x a_z) * (x c_y - x a_y)) * (x eye_x - x a_x) +
     ((x b_z - x a_z) * (x c_x - x a_x) - (x b_x - x a_x) * (x c_z - x a_z)) * (x eye_y - x a_y) +
     ((x b_x - x a_x) * (x c_y - x a_y) - (x b_y - x a_y) * (x c_x - x a_x)) * (x eye_z - x a_z)).
Proof. cbv [value real]. ring. Qed.

(* Three coordinates. *)
Definition thrice := Times (3 * (1048577 # 1048576)) size.
Definition constant : Q := bound_constant / (3 * (1048577 # 1048576)) * (1 - (4 # 2 ^ 24)).

Lemma products : permanent x value <= permanent x thrice.
Proof.
  assert (E0 := Rabs_pos (x eye_x)). assert (A0 := Rabs_pos (x a_x)).
  assert (HE := Rabs_pos_eq (x E) ltac:(lra)). assert (HA := Rabs_pos_eq (x A) ltac:(lra)).
  assert (three : Rabs (Q2R (3 * (1048577 # 1048576))) = 3 * most).
  { unfold most, Q2R; simpl; rewrite Rabs_pos_eq; lra. }
  assert (one : forall n y w, 0 <= n -> n <= most -> 0 <= y -> y <= w -> n * y <= most * w).
  { intros. apply Rmult_le_compat; lra. }
  cbv [value thrice size permanent]. rewrite three, HE, HA.
  unfold products_of in *.
  match type of n_x_in with ?n <= _ => set (nx := n) in * end.
  match type of n_y_in with ?n <= _ => set (ny := n) in * end.
  match type of n_z_in with ?n <= _ => set (nz := n) in * end.
  assert (P : forall i j k l m n o p, 0 <= (Rabs (x i - x j) * Rabs (x k - x l) + Rabs (x m - x n) * Rabs (x o - x p)) *
    Rabs (x scale)).
  { intros. apply Rmult_le_pos; [apply Rplus_le_le_0_compat; apply Rmult_le_pos |]; apply Rabs_pos. }
  assert (Nx : 0 <= nx) by apply P. assert (Ny : 0 <= ny) by apply P. assert (Nz : 0 <= nz) by apply P.
  assert (B1 := one nx _ _ Nx n_x_in (Rabs_pos _) eye_x_in). assert (B2 := one ny _ _ Ny n_y_in (Rabs_pos _) eye_y_in).
  assert (B3 := one nz _ _ Nz n_z_in (Rabs_pos _) eye_z_in). assert (B4 := one nx _ _ Nx n_x_in (Rabs_pos _) a_x_in).
  assert (B5 := one ny _ _ Ny n_y_in (Rabs_pos _) a_y_in). assert (B6 := one nz _ _ Nz n_z_in (Rabs_pos _) a_z_in).
  unfold nx, ny, nz in *. lra.
Qed.

(* What underflow takes of n, and of the value. *)
Local Notation h := h32.
Let taken := taken x (all h32Q).
Hypothesis scale_in : Rabs (x scale) <= 576460752303423488.  (* 2^59 *)
Let side i j := Rabs (x i - x j) <= 2097152.  (* 2^21 *)
Hypotheses (b_x_in : side b_x a_x) (b_y_in : side b_y a_y) (b_z_in : side b_z a_z).
Hypotheses (c_x_in : side c_x a_x) (c_y_in : side c_y a_y) (c_z_in : side c_z a_z).
Definition normal i j k l m n o p := Mul (Given scale 0) (Sub (Mul (Diff i j) (Diff k l)) (Mul (Diff m n) (Diff o p))).
Definition rest_of_n : Q := 1 # 1099511627776.  (* 2^-40 *)
Lemma normal_loses i j k l m n o p : side i j -> side k l -> side m n -> side o p ->
  taken (normal i j k l m n o p) <= Q2R rest_of_n.
Proof.
  intros. apply (taken_of_limits x (all h32Q) (all (576460752303423488 # 1)) (apart (2097152 # 1)));
    [apply all_may_lose | vm_compute; reflexivity |].
  cbn -[Q2R]. unfold all, apart. replace (Q2R (576460752303423488 # 1)) with 576460752303423488 by (unfold Q2R; simpl; lra).
  replace (Q2R (2097152 # 1)) with 2097152 by (unfold Q2R; simpl; lra). auto.
Qed.
(* A product of n and a coordinate. *)
Lemma product_loses i n : roundings n = 5%nat -> permanent x n <= most -> taken n <= Q2R rest_of_n ->
  taken (Mul (Given i 0) n) <= / 2 ^ 39 * Rabs (x i) + 21 / 10 * h.
Proof.
  intros Rn P T. assert (P0 := permanent_positive x n). assert (h0 := h32_powers). assert (g0 := Rabs_pos (x i)).
  assert (T0 : 0 <= taken n) by (apply lost_positive; [apply bpow_ge_0 | apply bpow_ge_0 | exact (keeps_range x _ (all_may_lose x))]).
  unfold taken, Filters.taken in *. cbn [lost permanent].
  assert (G : forall e, 0 <= gap h (fun i => Q2R (all h32Q i)) e <= h)
    by (intros e; apply gap_range; [apply bpow_ge_0 | exact (keeps_range x _ (all_may_lose x))]).
  assert (Gi := G (Given i 0)). assert (Gn := G n). set (gi := gap _ _ (Given i 0)) in *. set (gn := gap _ _ n) in *.
  rewrite Rn. unfold of_product. assert (A := alpha_below 5 ltac:(lia)). simpl INR in A.
  replace (alpha u32 (roundings (Given i 0))) with 0 by (unfold alpha; simpl; lra).
  replace (Q2R rest_of_n) with (/ 2 ^ 40) in T
    by (unfold Q2R, rest_of_n; simpl; lra). assert (u0 := u32_value). set (t := lost u32 h x _ n) in *.
  assert (most_is : most <= 1001 / 1000) by (unfold most, Q2R; simpl; lra).
  assert (B := alpha_at_least 5).
  assert (G1 : Rabs (x i) * (t + gn) <= Rabs (x i) * (1001 / 1000 * / 2 ^ 40)) by (apply Rmult_le_compat_l; lra).
  assert (G2 : (1 + alpha u32 5) * permanent x n <= 1001 / 1000 * (1001 / 1000)) by (apply Rmult_le_compat; lra).
  assert (G3 : (1 + alpha u32 5) * permanent x n * (0 + gi) <= 1001 / 1000 * (1001 / 1000) * h).
  { apply Rmult_le_compat; try lra. apply Rmult_le_pos; lra. }
  assert (G4 : (0 + gi) * (t + gn) <= h * (1001 / 1000 * / 2 ^ 40)) by (apply Rmult_le_compat; lra).
  set (al := alpha u32 5) in *. rewrite u0. lra.
Qed.
Lemma sum_loses a b p q : taken a <= p -> taken b <= q ->
  taken (Add a b) <= (1 + / 16777216) * (p + q + 2 * h) + h /\ taken (Sub a b) <= (1 + / 16777216) * (p + q + 2 * h) + h.
Proof.
  intros P Q. assert (h0 := h32_positive).
  assert (G : forall e, 0 <= gap h (fun i => Q2R (all h32Q i)) e <= h)
    by (intros e; apply gap_range; [apply bpow_ge_0 | exact (keeps_range x _ (all_may_lose x))]).
  unfold taken, Filters.taken in *. cbn [lost]. assert (Ga := G a). assert (Gb := G b). rewrite u32_value in *. lra.
Qed.
Definition n_x := normal b_y a_y c_z a_z b_z a_z c_y a_y.
Definition n_y := normal b_z a_z c_x a_x b_x a_x c_z a_z.
Definition n_z := normal b_x a_x c_y a_y b_y a_y c_x a_x.
Lemma value_is_of_n : value =
  Add (Add (Mul (Given eye_x 0) n_x) (Mul (Given eye_y 0) n_y))
      (Sub (Mul (Given eye_z 0) n_z) (Add (Add (Mul (Given a_x 0) n_x) (Mul (Given a_y 0) n_y)) (Mul (Given a_z 0) n_z))).
Proof. reflexivity. Qed.
Lemma value_loses : taken value <= / 2 ^ 36 * (x E + x A) + 29 * h.
Proof.
  assert (P : permanent x n_x <= most /\ permanent x n_y <= most /\ permanent x n_z <= most).
  { unfold products_of in *. cbn [permanent n_x n_y n_z normal]. repeat split; lra. }
  assert (T : taken n_x <= Q2R rest_of_n /\ taken n_y <= Q2R rest_of_n /\ taken n_z <= Q2R rest_of_n)
    by (repeat split; now apply normal_loses).
  rewrite value_is_of_n. assert (h0 := h32_positive).
  assert (Ex := product_loses eye_x n_x eq_refl ltac:(tauto) ltac:(tauto)).
  assert (Ey := product_loses eye_y n_y eq_refl ltac:(tauto) ltac:(tauto)).
  assert (Ez := product_loses eye_z n_z eq_refl ltac:(tauto) ltac:(tauto)).
  assert (Ax := product_loses a_x n_x eq_refl ltac:(tauto) ltac:(tauto)).
  assert (Ay := product_loses a_y n_y eq_refl ltac:(tauto) ltac:(tauto)).
  assert (Az := product_loses a_z n_z eq_refl ltac:(tauto) ltac:(tauto)).
  destruct (sum_loses _ _ _ _ Ax Ay) as [S1 _]. destruct (sum_loses _ _ _ _ S1 Az) as [S2 _].
  destruct (sum_loses _ _ _ _ Ez S2) as [_ S3]. destruct (sum_loses _ _ _ _ Ex Ey) as [S4 _].
  destruct (sum_loses _ _ _ _ S4 S3) as [S5 _].
  assert (E0 := Rabs_pos (x eye_x)). assert (A0 := Rabs_pos (x a_x)). eapply Rle_trans; [exact S5 | lra].
Qed.
(* 2^-30 of the size is left for what is in proportion to it. *)
Definition least_bound :=
  Eval vm_compute in (3 * (1048577 # 1048576) * (rate u32Q value thrice + (1 # 2 ^ 30)) / (1 - (4 # 2 ^ 24)))%Q.

Theorem error v s : computes32 x value v -> computes32 x thrice s -> 0 <= s ->
  Rabs (v - real x value) <= Q2R constant * s + / 2 * Q2R bound_rest.
Proof.
  intros Cv Cs s0. assert (E0 := Rabs_pos (x eye_x)). assert (A0 := Rabs_pos (x a_x)).
  assert (HE := Rabs_pos_eq (x E) ltac:(lra)). assert (HA := Rabs_pos_eq (x A) ltac:(lra)). assert (h0 := h32_powers).
  assert (three : Q2R (3 * (1048577 # 1048576)) = 3145731 / 1048576) by (unfold Q2R; simpl; lra).
  assert (real_is : real x thrice = permanent x thrice).
  { cbv [thrice size real permanent]. rewrite !HE, HA, Rabs_pos_eq; [reflexivity | lra]. }
  assert (N := error_but_taken x (all h32Q) value thrice (constant - (1 # 1073741824)) v s (all_may_lose x)
    ltac:(vm_compute; reflexivity) ltac:(vm_compute; reflexivity) products real_is Cv Cs).
  fold (taken value) (taken thrice) in N. assert (L := value_loses).
  assert (T : taken thrice <= 20 * h).
  { unfold taken, Filters.taken. cbn -[u32 h32 Q2R]. unfold all. rewrite three, h32_is, u32_value, Rabs_pos_eq by lra. lra. }
  assert (s_is : 3 * (x E + x A) * (999 / 1000) <= s + 40 * h).
  { assert (F := near32 x thrice s Cs). unfold lost32 in F. cbn -[u32 h32 alpha Q2R] in F.
    rewrite !HE, HA, three, (Rabs_pos_eq (3145731 / 1048576)) in F by lra.
    assert (B := alpha_below 2 ltac:(lia)). simpl INR in B.
    assert (G := Rmult_le_compat_r (3145731 / 1048576 * (x E + x A)) _ _ ltac:(lra) B).
    set (al := alpha u32 2) in *. rewrite u32_value in F. apply between in F. lra. }
  rewrite Q2R_minus in N. replace (Q2R (1 # 1073741824)) with (/ 2 ^ 30) in N by (unfold Q2R; simpl; lra).
  assert (c1 : 0 <= Q2R constant <= / 1000).
  { split; [rewrite <- Q2R_0' | replace (/ 1000) with (Q2R (1 # 1000)) by (unfold Q2R; simpl; lra)]; apply Qle_Rle;
    apply Qle_bool_iff; vm_compute; reflexivity. }
  assert (T0 : 0 <= taken thrice)
    by (apply lost_positive; [apply bpow_ge_0 | apply bpow_ge_0 | exact (keeps_range x _ (all_may_lose x))]).
  assert (rest : Q2R ((60 # 1) * h32Q) <= Q2R bound_rest) by (apply Qle_Rle, Qle_bool_iff; vm_compute; reflexivity).
  rewrite Q2R_mult, h32_is in rest. replace (Q2R (60 # 1)) with 60 in rest by (unfold Q2R; simpl; lra).
  assert (C2 : (Q2R constant - / 2 ^ 30) * taken thrice <= / 1000 * (20 * h)).
  { eapply Rle_trans; [apply Rmult_le_compat_r; [exact T0 |] | apply Rmult_le_compat_l; [| exact T]]; lra. }
  lra.
Qed.
End Plane.
(* A scale is half the inverse of a power of two that is at least PLANE_LEAST, which is one as well. *)
Definition least_size : Q := match plane_least with Const c => c | _ => 0%Q end.
Lemma scale_is_enough : Qle_bool (1 # 2) (576460752303423488 * least_size) = true.
Proof. vm_compute. reflexivity. Qed.
Definition constants := Eval vm_compute in shown least_bound bound_constant.
Print constants.
Definition checked := (error, scale_is_enough).
Print Assumptions checked.
