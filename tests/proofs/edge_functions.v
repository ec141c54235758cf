(* SPDX-License-Identifier: MIT *)
(* triangle_records.clh: the roundings of an edge function at a point of the grid, from the projected vertices as they
  are
   computed: 6 u Q (docs/numerics.md, 4).

   Assumed: |X|, |Y| <= reach; no product is below 2^-126 unless it is 0. (What underflow takes is below
     PROJECTION_UNDERFLOW
   times the other factors, which the margin's first term has: prose.) Overflow: coordinates are below 1e12. *)
From Coq Require Import Reals QArith Lra Psatz.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition a_z := 2%nat.
Definition b_x := 3%nat.
Definition b_y := 4%nat.
Definition b_z := 5%nat.
Definition X := 6%nat.
Definition Y := 7%nat.
Definition reach := 8%nat.
Definition value :=
  Fma (Fma (Given a_y 0) (Diff b_z a_z) (Mul (Neg (Given a_z 0)) (Diff b_y a_y))) (Given X 0) (Fma (Fma (Given a_z
    0) (Diff b_x a_x) (Mul (Neg (Given a_x 0)) (Diff b_z a_z))) (Given Y 0) (Fma (Given a_x 0) (Diff b_y a_y) (Mul
    (Neg (Given a_y 0)) (Diff b_x a_x)))).
Definition size :=
  Add (Add (Abs (Mul (Given a_x 0) (Diff b_y a_y))) (Abs (Mul (Given a_y 0) (Diff b_x a_x)))) (Mul (Add (Add (Abs
    (Mul (Given a_x 0) (Diff b_z a_z))) (Abs (Mul (Given a_z 0) (Diff b_x a_x)))) (Add (Abs (Mul (Given a_y 0) (Diff
    b_z a_z))) (Abs (Mul (Given a_z 0) (Diff b_y a_y))))) (Given reach 0)).
(* bound = bound_constant * size *)
Definition bound_constant : Q := 3 # 8388608.
(* end: from the kernels *)

Section Edge.
Variable x : nat -> R.
Open Scope R_scope.
Hypotheses (X_in_reach : Rabs (x X) <= x reach) (Y_in_reach : Rabs (x Y) <= x reach).

(* det(a, b, p), p = (X, Y, 1), the third coordinates being the w. *)
Lemma value_is_the_edge_function :
  real x value = x a_x * (x b_y * 1 - x b_z * x Y) - x a_y * (x b_x * 1 - x b_z * x X) +
                 x a_z * (x b_x * x Y - x b_y * x X).
Proof. cbv [value real]. ring. Qed.

Definition least_bound := Eval vm_compute in rate u32Q value size.

Theorem error v s :
  within_limits x (Q2R any) (Q2R any) value -> within_limits x (Q2R any) (Q2R any) size ->
  computes_normal x value v -> computes_normal x size s -> 0 <= s ->
  Rabs (v - real x value) <= Q2R bound_constant * s.
Proof.
  assert (r0 := Rabs_pos (x X)). assert (r := Rabs_pos_eq (x reach) ltac:(lra)).
  intros. eapply float_error_of_normal_numbers with (size := size) (m := fun _ => any) (d := fun _ _ => any); try
    eassumption.
  - vm_compute. reflexivity.
  - cbv [value size permanent]. rewrite !r.
    assert (P := fun i j k => Rmult_le_pos _ _ (Rabs_pos (x i)) (Rabs_pos (x j - x k))).
    assert (G1 := Rmult_le_compat_l _ _ _ (Rplus_le_le_0_compat _ _ (P a_y b_z a_z) (P a_z b_y a_y)) X_in_reach).
    assert (G2 := Rmult_le_compat_l _ _ _ (Rplus_le_le_0_compat _ _ (P a_z b_x a_x) (P a_x b_z a_z)) Y_in_reach). lra.
  - cbv [size real permanent]. rewrite !Rabs_mult, !r. ring.
Qed.
End Edge.
Definition constants := Eval vm_compute in shown (least_bound) (bound_constant).
Print constants.
Print Assumptions error.
