(* SPDX-License-Identifier: MIT *)
(* loose: BEAM_ROUNDING also serves the extents of leaves along a light's axes, which need 3.2e-6 (leaf_extents.v) *)
(* beam_sides.clh: the planes of a beam against the tree's boxes and triangles. What lies on the rays' side of a
   plane is never computed beyond the plane's limit, so that no node and no triangle that a ray meets is left out.

   Assumed: no coordinate of the normal exceeds 1, none of points and triangles L; `rounding` is at least 0.9999 of
   BEAM_ROUNDING L + BEAM_ROUNDING_LEAST (the host rounds it twice). Denormals may be kept or flushed. In prose (docs/numerics.md,
   16): that a beam's rays lie on that side, which the host verifies in double, or which holds for any normal (point
   lights; the lights' own limits round by as much); that the farthest corner of a box along a normal is the one
   that its signs choose. Boxes of rays and packets: boxes.v. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition n_x := 0%nat.
Definition n_y := 1%nat.
Definition n_z := 2%nat.
Definition X_x := 3%nat.
Definition X_y := 4%nat.
Definition X_z := 5%nat.
Definition P_x := 6%nat.
Definition P_y := 7%nat.
Definition P_z := 8%nat.
Definition rounding := 9%nat.
Definition along :=
  Fma (Given X_x 0) (Given n_x 0) (Fma (Given X_y 0) (Given n_y 0) (Mul (Given X_z 0) (Given n_z 0))).
Definition limit :=
  Add (Fma (Given P_x 0) (Given n_x 0) (Fma (Given P_y 0) (Given n_y 0) (Mul (Given P_z 0) (Given n_z 0)))) (Given
    rounding 0).
Definition factor :=
  Const (8796093 # 2199023255552).
Definition factor_of_positions :=
  Const (8796093 # 1099511627776).
Definition of_nothing :=
  Const (332307 # 332306998946228968225951765070086144).
(* end: from the kernels *)

Section Plane.
Open Scope R_scope.
Variable x : nat -> R.
Variable L : R.
Let below_one i := Rabs (x i) <= 1.
Let in_scene i := Rabs (x i) <= L.
Hypotheses (n_x_in : below_one n_x) (n_y_in : below_one n_y) (n_z_in : below_one n_z).
Hypotheses (X_x_in : in_scene X_x) (X_y_in : in_scene X_y) (X_z_in : in_scene X_z).
Hypotheses (P_x_in : in_scene P_x) (P_y_in : in_scene P_y) (P_z_in : in_scene P_z).

(* Twice three products that round three times, and the limit's sum; and what underflow takes. *)
Definition least_factor : Q := 22 # 16777216.
Definition least_rest : Q := 1 # 1298074214633706907132624082305024.  (* 2^-110 *)
Theorem none_is_beyond a l :
  real x along <= x n_x * x P_x + x n_y * x P_y + x n_z * x P_z ->
  Q2R least_factor * L + Q2R least_rest <= x rounding -> computes32 x along a -> computes32 x limit l -> a <= l.
Proof.
  intros side r Na Nl. apply near32 in Na, Nl. assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  unfold lost32 in Na, Nl. cbn -[u32 h32 alpha] in Na, Nl, side. unfold of_product, alpha in Na, Nl.
  rewrite ?u32_value in Na, Nl. simpl pow in Na, Nl.
  replace (Q2R least_factor) with (22 / 16777216) in r by (unfold Q2R, least_factor; simpl; lra).
  replace (Q2R least_rest) with (/ 1298074214633706907132624082305024) in r by (unfold Q2R, least_rest; simpl; lra).
  assert (L0 : 0 <= L) by (eapply Rle_trans; [apply Rabs_pos | exact X_x_in]).
  assert (product : forall i j, in_scene i -> below_one j -> 0 <= Rabs (x i) * Rabs (x j) <= L * 1).
  { intros. split; [apply Rmult_le_pos; apply Rabs_pos | apply Rmult_le_compat; auto using Rabs_pos]. }
  assert (A1 := product _ _ X_x_in n_x_in). assert (A2 := product _ _ X_y_in n_y_in).
  assert (A3 := product _ _ X_z_in n_z_in). assert (B1 := product _ _ P_x_in n_x_in).
  assert (B2 := product _ _ P_y_in n_y_in). assert (B3 := product _ _ P_z_in n_z_in).
  assert (times : forall i b, Rabs (x i) <= b -> 0 <= h32 * Rabs (x i) <= h32 * b).
  { intros i b H. split; [apply Rmult_le_pos; [lra | apply Rabs_pos] | apply Rmult_le_compat_l; lra]. }
  assert (C1 := times _ _ X_x_in). assert (C2 := times _ _ X_y_in). assert (C3 := times _ _ X_z_in).
  assert (C4 := times _ _ P_x_in). assert (C5 := times _ _ P_y_in). assert (C6 := times _ _ P_z_in).
  assert (C7 := times _ _ n_x_in). assert (C8 := times _ _ n_y_in). assert (C9 := times _ _ n_z_in).
  assert (hL : 0 <= h32 * L <= / 85070591730234615865843651857942052864 * L).
  { split; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra. }
  assert (hh : 0 <= h32 * h32 <= h32) by (split; [apply Rmult_le_pos | rewrite <- (Rmult_1_r h32) at 3; apply
    Rmult_le_compat_l]; lra).
  assert (r0 : 0 <= x rounding) by lra. rewrite (Rabs_pos_eq _ r0) in Nl. unfold below_one, in_scene in *.
  apply between in Na. apply between in Nl. lra.
Qed.
End Plane.
Definition of_expr e := match e with Const q => q | _ => 0%Q end.
Lemma host_is_enough : Qle_bool least_rest ((9999 # 10000) * of_expr of_nothing) = true /\
  Qle_bool least_factor ((9999 # 10000) * of_expr factor) = true /\
  Qle_bool least_factor ((9999 # 10000) * of_expr factor_of_positions) = true.
Proof. vm_compute. auto. Qed.
Definition constants := Eval vm_compute in shown least_factor (of_expr factor).
Print constants.
Definition checked := (none_is_beyond, host_is_enough).
Print Assumptions checked.
