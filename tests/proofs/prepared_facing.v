(* SPDX-License-Identifier: MIT *)
(* prepared_facing.clh: how far the eye is above a triangle's plane, n . eye - n . a, against 32 u (E + A).

   Assumed: no coordinate of the eye exceeds E, none of the triangle A; the sizes in n times the scale are at most
   1 + 2^-20 (1 as they are computed); no result is below 2^-126 unless it is 0 (2^-120 and PLANE_LEAST cover underflow:
   prose). The bound rounds twice more than `size`. Overflow: the bound is infinite beyond 2^100. *)
From Coq Require Import Reals QArith Lra Psatz.
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
Definition least_bound :=
  Eval vm_compute in (3 * (1048577 # 1048576) * rate u32Q value thrice / (1 - (4 # 2 ^ 24)))%Q.

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

Theorem error v s :
  within_limits x (Q2R any) (Q2R any) value -> within_limits x (Q2R any) (Q2R any) thrice ->
  computes_normal x value v -> computes_normal x thrice s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s.
Proof.
  assert (E0 := Rabs_pos (x eye_x)). assert (A0 := Rabs_pos (x a_x)).
  assert (HE := Rabs_pos_eq (x E) ltac:(lra)). assert (HA := Rabs_pos_eq (x A) ltac:(lra)).
  intros. eapply float_error_of_normal_numbers with (size := thrice) (m := fun _ => any) (d := fun _ _ => any); try
    eassumption.
  - vm_compute. reflexivity.
  - apply products.
  - cbv [thrice size real permanent]. rewrite !HE, HA.
    rewrite (Rabs_pos_eq (Q2R (3 * (1048577 # 1048576)))) by (unfold Q2R; simpl; lra). reflexivity.
Qed.
End Plane.
Definition constants := Eval vm_compute in shown least_bound bound_constant.
Print constants.
Print Assumptions error.
