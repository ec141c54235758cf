(* SPDX-License-Identifier: MIT *)
(* loose: 4 roundings against 16 u; a triangle between the two is no height field's, or too thin to matter *)
(* height_field.cl: twice the area of a triangle over the ground, against 2^-20 (|left| + |right|) + 2^-110 sizes.

   Assumed: the coordinates are finite floats. Overflow: nothing is certain where the bound is infinite or a NaN. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition b_x := 2%nat.
Definition b_y := 3%nat.
Definition c_x := 4%nat.
Definition c_y := 5%nat.
Definition value :=
  Sub (Mul (Diff b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x)).
Definition bound :=
  Add (Times (1 # 1048576) (Add (Abs (Mul (Diff b_x a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x
    a_x))))) (Times (1 # 1298074214633706907132624082305024) (Add (Abs (Diff c_y a_y)) (Add (Abs (Diff c_x a_x))
    (Add (Abs (Diff b_y a_y)) (Add (Abs (Diff b_x a_x)) (Const (1 # 1))))))).
(* end: from the kernels *)

Section Winding.
Variable x : nat -> R.
Open Scope R_scope.

Lemma value_is_the_area :
  real x value = (x b_x - x a_x) * (x c_y - x a_y) - (x b_y - x a_y) * (x c_x - x a_x).
Proof. reflexivity. Qed.

(* What the bound's first and second part compute. *)
Definition size := Add (Abs (Mul (Diff b_x a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x))).
Definition sizes :=
  Add (Abs (Diff c_y a_y)) (Add (Abs (Diff c_x a_x)) (Add (Abs (Diff b_y a_y)) (Add (Abs (Diff b_x a_x)) (Const 1)))).
Lemma bound_is : bound = Add (Times (1 # 1048576) size) (Times (1 # 1298074214633706907132624082305024) sizes).
Proof. reflexivity. Qed.

Definition least_bound := Eval vm_compute in rate u32Q value size.

(* `all` is what `sizes` computes: it bounds every factor. *)
Let all := permanent x sizes.

Lemma limits_value : within_limits x all all value.
Proof.
  unfold all. cbv [value sizes within_limits within permanent].
  repeat split; sizes_are_positive; lra.
Qed.
Lemma limits_bound : within_limits x all all bound.
Proof.
  unfold all. cbv [bound size sizes within_limits within permanent].
  repeat split; sizes_are_positive; lra.
Qed.

Theorem error v b : computes32 x value v -> computes32 x bound b -> Rabs (v - real x value) <= b.
Proof.
  intros Cv Cb. assert (u0 : 0 <= u32) by apply bpow_ge_0. assert (h0 : 0 <= h32) by apply bpow_ge_0.
  assert (fr : nat -> 0 <= h32 <= h32) by (intros; lra).
  assert (fn : forall (i k : nat) v w, (k <= 16)%nat -> Rabs (v - x i) <= alpha u32 k * Rabs (x i) -> seen32 v w ->
    Rabs (w - v) <= h32)
    by (intros; now apply seen32_near).
  assert (Nv := computed_is_near u32 h32 u0 h0 rounds32 seen32 rounds32_near seen32_near x (fun _ => h32) fr fn (fun _
    => all) (fun _ _ => all) value v limits_value Cv).
  assert (Nb := computed_is_near u32 h32 u0 h0 rounds32 seen32 rounds32_near seen32_near x (fun _ => h32) fr fn (fun _
    => all) (fun _ _ => all) bound b limits_bound Cb).
  apply between in Nb. set (P := permanent x value) in *.
  assert (P0 : 0 <= P) by apply permanent_positive.
  assert (S1 : 1 <= all).
  { unfold all. cbv [sizes permanent]. rewrite (Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra).
    sizes_are_positive. unfold Q2R; simpl; lra. }
  assert (Pb : permanent x bound = Q2R (1 # 1048576) * P + Q2R (1 # 1298074214633706907132624082305024) * all).
  { unfold P, all. rewrite bound_is. cbn [permanent value size sizes].
    rewrite !(Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra). cbv [size value permanent]. ring. }
  assert (Rb : real x bound = permanent x bound).
  { cbv [bound size sizes real permanent]. rewrite !Rabs_mult, !(Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra).
    ring. }
  rewrite Rb, Pb in Nb. set (S := all) in *. set (E := Rabs (v - real x value)) in *. clearbody P S E. clear - Nv Nb
    P0 S1.
  by_roundings Nv Nb.
Qed.
End Winding.
Definition constants := Eval vm_compute in shown (least_bound) (1 # 2 ^ 20)%Q.
Print constants.
Print Assumptions error.
