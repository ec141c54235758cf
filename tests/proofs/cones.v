(* SPDX-License-Identifier: MIT *)
(* beam_intersect.clh: the least value of an edge for the directional lights of a cone, c - r of docs/numerics.md,
   16, against CONE_BOUNDS times the bound of one light. (The greatest has the same terms.)

   Assumed: no coordinate of the cone's vectors exceeds 1, and no difference 2^21. Denormals may be kept or flushed:
   what that takes is below 2^-64, of CONE_BOUNDS times BEAM_UNDERFLOW. The kernel multiplies the bound's factors
   with at most 6 roundings. A box of point lights: light_boxes.v. Overflow: nothing exceeds 2^50. *)
From Coq Require Import Reals QArith Lra Psatz.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition A_x := 0%nat.
Definition A_y := 1%nat.
Definition A_z := 2%nat.
Definition B_x := 3%nat.
Definition B_y := 4%nat.
Definition B_z := 5%nat.
Definition P_x := 6%nat.
Definition P_y := 7%nat.
Definition P_z := 8%nat.
Definition cone_1_0 := 9%nat.
Definition cone_1_1 := 10%nat.
Definition cone_1_2 := 11%nat.
Definition cone_2_0 := 12%nat.
Definition cone_2_1 := 13%nat.
Definition cone_2_2 := 14%nat.
Definition cone_3_0 := 15%nat.
Definition cone_3_1 := 16%nat.
Definition cone_3_2 := 17%nat.
Definition value :=
  Sub (Fma (Fma (Diff A_y P_y) (Diff B_z A_z) (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Given cone_1_0 0) (Fma
    (Fma (Diff A_z P_z) (Diff B_x A_x) (Mul (Neg (Diff A_x P_x)) (Diff B_z A_z))) (Given cone_1_1 0) (Mul (Fma (Diff
    A_x P_x) (Diff B_y A_y) (Mul (Neg (Diff A_y P_y)) (Diff B_x A_x))) (Given cone_1_2 0)))) (Add (Abs (Fma (Fma
    (Diff A_y P_y) (Diff B_z A_z) (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Given cone_2_0 0) (Fma (Fma (Diff A_z
    P_z) (Diff B_x A_x) (Mul (Neg (Diff A_x P_x)) (Diff B_z A_z))) (Given cone_2_1 0) (Mul (Fma (Diff A_x P_x) (Diff
    B_y A_y) (Mul (Neg (Diff A_y P_y)) (Diff B_x A_x))) (Given cone_2_2 0))))) (Abs (Fma (Fma (Diff A_y P_y) (Diff
    B_z A_z) (Mul (Neg (Diff A_z P_z)) (Diff B_y A_y))) (Given cone_3_0 0) (Fma (Fma (Diff A_z P_z) (Diff B_x A_x)
    (Mul (Neg (Diff A_x P_x)) (Diff B_z A_z))) (Given cone_3_1 0) (Mul (Fma (Diff A_x P_x) (Diff B_y A_y) (Mul (Neg
    (Diff A_y P_y)) (Diff B_x A_x))) (Given cone_3_2 0)))))).
Definition size :=
  Mul (Add (Abs (Diff A_z P_z)) (Add (Abs (Diff A_x P_x)) (Abs (Diff A_y P_y)))) (Add (Abs (Diff B_z A_z)) (Add (Abs
    (Diff B_x A_x)) (Abs (Diff B_y A_y)))).
Definition bound :=
  Times (4 # 1) (Times (9147937 # 17592186044416) size).
(* end: from the kernels *)

Section Cone.
Variable x : nat -> R.
Open Scope R_scope.
Let below_one i := Rabs (x i) <= 1.
Hypotheses (middle_x : below_one cone_1_0) (middle_y : below_one cone_1_1) (middle_z : below_one cone_1_2).
Hypotheses (across_x : below_one cone_2_0) (across_y : below_one cone_2_1) (across_z : below_one cone_2_2).
Hypotheses (along_x : below_one cone_3_0) (along_y : below_one cone_3_1) (along_z : below_one cone_3_2).

Definition kernels_constant : Q := match bound with Times b (Times c _) => b * c | _ => 0 end.
Lemma bound_is : exists b c, bound = Times b (Times c size) /\ kernels_constant = (b * c)%Q.
Proof. do 2 eexists. split; reflexivity. Qed.

(* Middle, across and along. *)
Definition thrice := Times 3 size.
Definition constant : Q := kernels_constant * (1 # 3) * (1 - (7 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (3 * rate u32Q value thrice / (1 - (7 # 2 ^ 24)))%Q.

Lemma products : permanent x value <= permanent x thrice.
Proof.
  assert (three : Rabs (Q2R 3) = 3) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  cbv [value thrice size permanent]. rewrite three.
  set (a := Rabs (x A_x - x P_x)). set (b := Rabs (x A_y - x P_y)). set (c := Rabs (x A_z - x P_z)).
  set (d := Rabs (x B_x - x A_x)). set (e := Rabs (x B_y - x A_y)). set (f := Rabs (x B_z - x A_z)).
  assert (P : forall i j k l, 0 <= Rabs (x i - x j) * Rabs (x k - x l)) by (intros; apply Rmult_le_pos; apply Rabs_pos).
  assert (0 <= b * f + c * e) by (apply Rplus_le_le_0_compat; apply P).
  assert (0 <= c * d + a * f) by (apply Rplus_le_le_0_compat; apply P).
  assert (0 <= a * e + b * d) by (apply Rplus_le_le_0_compat; apply P).
  assert (0 <= a * d) by apply P. assert (0 <= b * e) by apply P. assert (0 <= c * f) by apply P.
  assert (one : forall i y, below_one i -> 0 <= y -> y * Rabs (x i) <= y).
  { intros i y Hi Hy. assert (G := Rmult_le_compat_l _ _ _ Hy Hi). lra. }
  assert (A1 := one _ (b * f + c * e) middle_x ltac:(lra)). assert (A2 := one _ (c * d + a * f) middle_y ltac:(lra)).
  assert (A3 := one _ (a * e + b * d) middle_z ltac:(lra)).
  assert (B1 := one _ (b * f + c * e) across_x ltac:(lra)). assert (B2 := one _ (c * d + a * f) across_y ltac:(lra)).
  assert (B3 := one _ (a * e + b * d) across_z ltac:(lra)).
  assert (C1 := one _ (b * f + c * e) along_x ltac:(lra)). assert (C2 := one _ (c * d + a * f) along_y ltac:(lra)).
  assert (C3 := one _ (a * e + b * d) along_z ltac:(lra)). lra.
Qed.

Theorem error v s :
  within_limits x (Q2R 1) (Q2R (2 ^ 21)) value -> within_limits x (Q2R 1) (Q2R (2 ^ 21)) thrice ->
  computes32 x value v -> computes32 x thrice s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s + Q2R (1 # 2
    ^ 64).
Proof.
  assert (three : Rabs (Q2R 3) = Q2R 3) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  intros. eapply float_error with (size := thrice) (f := all h32Q) (m := all 1) (d := apart (2 ^ 21)); try
    eassumption; try exact (all_may_lose x).
  - vm_compute. reflexivity.
  - apply products.
  - cbv [thrice size real permanent]. rewrite three. reflexivity.
Qed.
End Cone.
Definition constants := Eval vm_compute in shown least_bound (Qred kernels_constant).
Print constants.
Print Assumptions error.
