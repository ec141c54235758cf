(* SPDX-License-Identifier: MIT *)
(* projection.h: a coordinate of a projected vertex is off by at most PROJECTION_ERROR g, here with what underflow adds.

   Assumed: a row's entries are within 4 roundings of the real map's (prose: they are a quotient and products on the host
   or device), and at most 2^32; the vertex and the centre are finite floats, at most 2^31 apart in each coordinate. Under a
   direction a small scene's rows are up to 2^76: there the offset is at least a fifth (frame_fit.v), which has what
   underflow takes, for rows and distances up to 2^80 (error_of_directions). Overflow: nothing exceeds 2^110. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
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

(* Under a direction the fit's offset is at least a fifth of a texel (frame_fit.v), and so the error at least 2^-24 and more
   than what underflow takes, for rows and distances up to 2^80: the rows of a small scene are up to 2^76. *)
Definition of_directions : Q := 1208925819614629174706176 # 1.  (* 2^80 *)
Definition rest_of_value : Q := 1 # 1099511627776.
Definition rest_of_size : Q := 1 # 1099511627776.
Lemma taken_of_both : Qle_bool (takes of_directions size) rest_of_size = true /\
  Qle_bool (takes of_directions value) rest_of_value = true.
Proof. vm_compute. auto. Qed.
Theorem error_of_directions v s : limited32 of_directions x value v -> limited32 of_directions x size s ->
  / 5 <= Rabs (x row_3) -> 19 / 100 <= s /\ Rabs (v - real x value) <= Q2R bound_constant * s.
Proof.
  intros Cv Cs o. destruct taken_of_both as [Ts Tv].
  apply (near_limited of_directions rest_of_size x size s Ts) in Cs.
  apply (near_limited of_directions rest_of_value x value v Tv) in Cv.
  replace (Q2R rest_of_size) with (/ 2 ^ 40) in * by (unfold Q2R, rest_of_size; simpl; lra).
  replace (Q2R rest_of_value) with (/ 2 ^ 40) in * by (unfold Q2R, rest_of_value; simpl; lra).
  assert (real_is : real x size = permanent x size).
  { cbv [size real permanent]. rewrite ?Rabs_Rabsolu. rewrite ?(Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra).
    reflexivity. }
  assert (product : forall p q, 0 <= p -> 0 <= q -> 0 <= p * q) by (intros; now apply Rmult_le_pos).
  assert (larger : Rabs (x row_3) <= permanent x size /\ permanent x value <= permanent x size).
  { cbv [value size permanent]. rewrite ?(Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra).
    assert (Q0 : 0 <= Q2R (1 # 1048576)) by (unfold Q2R; simpl; lra).
    match goal with |- ?a <= ?a + (?b + ?c + ?d) + ?e /\ _ =>
      assert (0 <= b) by (apply product; apply Rabs_pos); assert (0 <= c) by (apply product; apply Rabs_pos);
      assert (0 <= d) by (apply product; apply Rabs_pos);
      assert (0 <= e) by (repeat first [exact Q0 | apply product | apply Rplus_le_le_0_compat | apply Rabs_pos]) end.
    split; lra. }
  assert (below : forall e (n : Q), Qle_bool (alphaQ u32Q (roundings e)) n = true -> alpha u32 (roundings e) <= Q2R n).
  { intros e n E. rewrite <- u32_is, <- alpha_is. now apply Qle_Rle, Qle_bool_iff. }
  assert (As := below size (1 # 100000)%Q ltac:(vm_compute; reflexivity)).
  assert (Av := below value (4769 # 10000000000)%Q ltac:(vm_compute; reflexivity)).
  replace (Q2R (1 # 100000)) with (/ 100000) in As by (unfold Q2R; simpl; lra).
  replace (Q2R (4769 # 10000000000)) with (4769 / 10000000000) in Av by (unfold Q2R; simpl; lra).
  assert (c : Q2R (48 # 100000000) <= Q2R bound_constant) by (apply Qle_Rle, Qle_bool_iff; vm_compute; reflexivity).
  replace (Q2R (48 # 100000000)) with (48 / 100000000) in c by (unfold Q2R; simpl; lra).
  rewrite real_is in Cs. apply between in Cs.
  assert (G := Rmult_le_compat_r (permanent x size) _ _ (permanent_positive x size) As).
  assert (H := Rmult_le_compat (alpha u32 (roundings value)) _ _ _ (alpha_at_least _) (permanent_positive x value) Av
    (proj2 larger)). assert (P0 := permanent_positive x size).
  assert (cs := Rmult_le_compat_r s _ _ ltac:(lra) c). split; lra.
Qed.
Lemma error_is_not_small : Qle_bool (1 # 2 ^ 24) (bound_constant * (19 # 100) * (1 - (4 # 2 ^ 24))) = true.
Proof. vm_compute. reflexivity. Qed.
End Projection.
Definition constants := Eval vm_compute in shown (least_bound) (bound_constant).
Print constants.
Definition rests := Eval vm_compute in shown (least_rest u32Q h32Q (all h32Q) (all (2 ^ 32)) (apart (2 ^ 31)) value
  size) bound_rest.
Print rests.
Definition checked := (error, error_of_directions, error_is_not_small).
Print Assumptions checked.
