(* SPDX-License-Identifier: MIT *)
(* loose: 4 roundings against 16 u; integers decide what lies between, rarely *)
(* normal_side.clh: the sign of n . (light - start), with bound = 2^-20 size + 2^-110 sizes.

   Assumed: the inputs are finite floats, none of |n|, |light - start| is above `sizes` (their sum and 1). Overflow: the
   kernel decides nothing where the bound is infinite or a NaN. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition normal_x := 0%nat.
Definition normal_y := 1%nat.
Definition normal_z := 2%nat.
Definition light_x := 3%nat.
Definition light_y := 4%nat.
Definition light_z := 5%nat.
Definition start_x := 6%nat.
Definition start_y := 7%nat.
Definition start_z := 8%nat.
Definition value :=
  Add (Add (Mul (Given normal_x 0) (Diff light_x start_x)) (Mul (Given normal_y 0) (Diff light_y start_y))) (Mul
    (Given normal_z 0) (Diff light_z start_z)).
Definition size :=
  Add (Abs (Mul (Given normal_z 0) (Diff light_z start_z))) (Add (Abs (Mul (Given normal_x 0) (Diff light_x
    start_x))) (Abs (Mul (Given normal_y 0) (Diff light_y start_y)))).
Definition sizes :=
  Add (Add (Abs (Given normal_z 0)) (Add (Abs (Given normal_x 0)) (Abs (Given normal_y 0)))) (Add (Abs (Diff light_z
    start_z)) (Add (Abs (Diff light_y start_y)) (Add (Abs (Diff light_x start_x)) (Const (1 # 1))))).
Definition bound :=
  Add (Times (1 # 1048576) size) (Times (1 # 1298074214633706907132624082305024) sizes).
(* end: from the kernels *)

Section NormalSide.
Variable x : nat -> R.
Open Scope R_scope.

Lemma value_is_the_product :
  real x value = x normal_x * (x light_x - x start_x) + x normal_y * (x light_y - x start_y) +
                 x normal_z * (x light_z - x start_z).
Proof. reflexivity. Qed.

(* The relative part: 4 roundings. The kernel's 16 u is kept: what lies between is decided by integers, rarely. *)
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
  { unfold P, all. cbn [permanent bound value size sizes].
    rewrite !(Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra). cbv [size value permanent]. ring. }
  assert (Rb : real x bound = permanent x bound).
  { cbv [bound size sizes real permanent]. rewrite !Rabs_mult, !(Rabs_pos_eq (Q2R _)) by (unfold Q2R; simpl; lra).
    ring. }
  rewrite Rb, Pb in Nb. set (S := all) in *. set (E := Rabs (v - real x value)) in *. clearbody P S E. clear - Nv Nb
    P0 S1.
  by_roundings Nv Nb.
Qed.
End NormalSide.
Definition constants := Eval vm_compute in shown (least_bound) (1 # 2 ^ 20)%Q.
Print constants.
Print Assumptions error.
