(* SPDX-License-Identifier: MIT *)
(* projection.h: a coordinate of a projected vertex is off by at most PROJECTION_ERROR g, here with what underflow adds.

   Assumed: a row's entries are within 4 roundings of the real map's (prose: they are a quotient and products on the
     host
   or device), and at most 2^32; the vertex and the centre are finite floats, at most 2^31 apart in each coordinate.
   Overflow: nothing exceeds 2^65. *)
From Coq Require Import Reals QArith Lra Psatz.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition vertex_x := 0%nat.
Definition vertex_y := 1%nat.
Definition vertex_z := 2%nat.
Definition center_x := 3%nat.
Definition center_y := 4%nat.
Definition center_z := 5%nat.
Definition row := 6%nat.
Definition row_1 := 7%nat.
Definition row_2 := 8%nat.
Definition row_3 := 9%nat.
Definition value :=
  Fma (Given row 4) (Diff vertex_x center_x) (Fma (Given row_1 4) (Diff vertex_y center_y) (Fma (Given row_2 4)
    (Diff vertex_z center_z) (Given row_3 4))).
Definition size :=
  Add (Add (Abs (Given row_3 4)) (Add (Add (Mul (Abs (Given row 4)) (Abs (Diff vertex_x center_x))) (Mul (Abs (Given
    row_1 4)) (Abs (Diff vertex_y center_y)))) (Mul (Abs (Given row_2 4)) (Abs (Diff vertex_z center_z))))) (Mul
    (Add (Abs (Diff vertex_z center_z)) (Add (Abs (Diff vertex_x center_x)) (Abs (Diff vertex_y center_y)))) (Times
    (1 # 1048576) (Add (Abs (Given row_2 4)) (Add (Abs (Given row 4)) (Abs (Given row_1 4)))))).
(* bound = bound_constant * size *)
Definition bound_constant : Q := 5 # 8388608.
Definition bound_rest : Q := 1 # 1237940039285380274899124224.
(* end: from the kernels *)

Section Projection.
Variable x : nat -> R.
Open Scope R_scope.

Lemma value_is_the_coordinate :
  real x value = x row * (x vertex_x - x center_x) + x row_1 * (x vertex_y - x center_y) +
                 x row_2 * (x vertex_z - x center_z) + x row_3.
Proof. cbv [value real]. ring. Qed.

Definition least_bound := Eval vm_compute in rate u32Q value size.

Theorem error v s :
  within_limits x (Q2R (2 ^ 32)) (Q2R (2 ^ 31)) value -> within_limits x (Q2R (2 ^ 32)) (Q2R (2 ^ 31)) size ->
  computes32 x value v -> computes32 x size s -> 0 <= s ->
  Rabs (v - real x value) <= Q2R bound_constant * s + Q2R bound_rest.
Proof.
  intros. eapply float_error with (size := size) (f := all h32Q) (m := all (2 ^ 32)) (d := apart (2 ^ 31)); try
    eassumption; try exact (all_may_lose x).
  - vm_compute. reflexivity.
  - cbv [value size permanent].
    assert (P := fun i j k => Rmult_le_pos _ _ (Rabs_pos (x i)) (Rabs_pos (x j - x k))).
    rewrite ?(Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra).
    assert (S := Rabs_pos (x vertex_x - x center_x)). assert (T := Rabs_pos (x vertex_y - x center_y)).
    assert (U := Rabs_pos (x vertex_z - x center_z)).
    assert (A := Rabs_pos (x row)). assert (B := Rabs_pos (x row_1)). assert (C := Rabs_pos (x row_2)).
    assert (0 <= (Rabs (x vertex_z - x center_z) + (Rabs (x vertex_x - x center_x) + Rabs (x vertex_y - x center_y))) *
      ((Rabs (x row_2) + (Rabs (x row) + Rabs (x row_1))) * Q2R (1 # 1048576))).
    { apply Rmult_le_pos; [lra |]. apply Rmult_le_pos; [lra |]. unfold Q2R; simpl; lra. }
    lra.
  - cbv [size real permanent]. rewrite ?Rabs_Rabsolu. rewrite ?(Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra).
    reflexivity.
Qed.
End Projection.
Definition constants := Eval vm_compute in shown (least_bound) (bound_constant).
Print constants.
Definition rests := Eval vm_compute in shown (least_rest u32Q h32Q (all h32Q) (all (2 ^ 32)) (apart (2 ^ 31)) value
  size) bound_rest.
Print rests.
Print Assumptions error.
