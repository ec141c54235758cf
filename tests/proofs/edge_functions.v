(* SPDX-License-Identifier: MIT *)
(* triangle_records.clh: the roundings of an edge function at a point of the grid, from the projected vertices as they are
   computed: 6 u Q and what underflow takes (docs/numerics.md, 4), which the margin's other terms have.

   Assumed: |X|, |Y| <= reach, which is from 1 to 2^16 (the grid has at most 2^14 texels a side, and a point's error is
   below 2^13), and no denormals (frame_fit.v: points are at least a fifth of a texel inside). Denormals may be
   kept or flushed. E_a and E_b, the errors of a and b relative to a point, are at least 2^-92 reach: in perspective
   error_w is PROJECTION_UNDERFLOW and more, under a direction the error is 2^-24 and more (projection.v). In prose: of
   the rectangle's two sides, which are a texel and more apart, one is half of |a_w| from a_x, at the least (rho_has);
   rho's roundings are within the 1 %. Overflow: coordinates are below 1e12.
   loose rests: underflow takes no more than a 20th of 1e-30, and no edge is decided by so little. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
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
Definition of_nothing :=
  Const (332307 # 332306998946228968225951765070086144).
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

(* What underflow takes, for vertices with coordinates up to S. *)
Definition may_lose i := if Nat.leb X i then 0%Q else h32Q.  (* not X, Y and reach *)
Hypothesis normal : forall i, (X <= i)%nat -> x i = 0 \/ 2 * h32 <= Rabs (x i).
Lemma kept : keeps x may_lose.
Proof.
  intros i. unfold may_lose. destruct (Nat.leb_spec X i); [right | now left]. split; [reflexivity | now apply normal].
Qed.
Variable S : R.
Let in_sizes i := Rabs (x i) <= S.
Hypotheses (a_x_in : in_sizes a_x) (a_y_in : in_sizes a_y) (a_z_in : in_sizes a_z).
Hypotheses (b_x_in : in_sizes b_x) (b_y_in : in_sizes b_y) (b_z_in : in_sizes b_z).
Let far := x reach.
Hypothesis R_in : 1 <= far <= 65536.
Definition limits i := if Nat.leb i b_z then S else far.
Definition differences (i j : nat) := 2 * S.
Lemma difference_in i j : in_sizes i -> in_sizes j -> Rabs (x i - x j) <= 2 * S.
Proof.
  unfold in_sizes. intros. unfold Rminus. eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp. lra.
Qed.
Definition of_underflow := h32 * (40 * (far * S) + 20 * far + 40 * S + 20).

Theorem error v s : computes32 x value v -> computes32 x size s ->
  Rabs (v - real x value) <= Q2R bound_constant * s + of_underflow.
Proof.
  assert (r0 := Rabs_pos (x X)). assert (r := Rabs_pos_eq (x reach) ltac:(lra)).
  intros Cv Cs.
  assert (E := error_but_taken x may_lose value size bound_constant v s kept ltac:(vm_compute; reflexivity)
    ltac:(vm_compute; reflexivity)).
  assert (D := fun i j H H' => difference_in i j H H').
  assert (Wv : within x limits differences value) by (cbn; unfold differences, far; repeat split; try assumption; auto).
  assert (Ws : within x limits differences size)
    by (cbn; unfold differences, far; repeat split; try assumption; auto; rewrite r; apply Rle_refl).
  assert (Tv := taken_within x may_lose limits differences value kept Wv).
  assert (Ts := taken_within x may_lose limits differences size kept Ws).
  eapply Rle_trans; [apply E; auto |].
  - cbv [value size permanent]. rewrite !r.
    assert (P := fun i j k => Rmult_le_pos _ _ (Rabs_pos (x i)) (Rabs_pos (x j - x k))).
    assert (G1 := Rmult_le_compat_l _ _ _ (Rplus_le_le_0_compat _ _ (P a_y b_z a_z) (P a_z b_y a_y)) X_in_reach).
    assert (G2 := Rmult_le_compat_l _ _ _ (Rplus_le_le_0_compat _ _ (P a_z b_x a_x) (P a_x b_z a_z)) Y_in_reach). lra.
  - cbv [size real permanent]. rewrite !Rabs_mult, !r. ring.
  - apply Rplus_le_compat_l. revert Tv Ts. unfold differences, limits. underflow_in_numbers. intros Tv Ts.
    destruct h32_powers as [h hh]. assert (S0 : 0 <= S) by (eapply Rle_trans; [apply Rabs_pos | exact a_x_in]).
    assert (RS : 0 <= far * S) by (apply Rmult_le_pos; lra).
    assert (hR := Rmult_le_pos h32 far ltac:(lra) ltac:(lra)). assert (hS := Rmult_le_pos h32 S ltac:(lra) S0).
    assert (hRS := Rmult_le_pos h32 (far * S) ltac:(lra) RS).
    assert (hhR := Rmult_le_compat_r far _ _ ltac:(lra) (proj2 hh)). assert (hhS := Rmult_le_compat_r S _ _ S0 (proj2 hh)).
    assert (hhR0 := Rmult_le_pos _ far (proj1 hh) ltac:(lra)). assert (hhS0 := Rmult_le_pos _ S (proj1 hh) S0).
    assert (hhh := Rmult_le_compat_r h32 _ _ ltac:(lra) (proj2 hh)). assert (hhh0 := Rmult_le_pos _ h32 (proj1 hh) ltac:(lra)).
    assert (c : 0 <= Q2R bound_constant <= / 1000).
    { split; [rewrite <- Q2R_0' | replace (/ 1000) with (Q2R (1 # 1000)) by (unfold Q2R; simpl; lra)]; apply Qle_Rle;
      apply Qle_bool_iff; vm_compute; reflexivity. }
    assert (T0 : 0 <= taken x may_lose size)
      by (apply lost_positive; [apply bpow_ge_0 | apply bpow_ge_0 | exact (keeps_range x _ kept)]).
    assert (cT := Rmult_le_compat_r _ _ _ T0 (proj2 c)). unfold of_underflow. lra.
Qed.

(* rho is at least as large as the distances of a to both sides, left and right. *)
Lemma rho_has w a left right rho : left + 1 <= right <= far -> 0 <= left ->
  Rabs (a - w * left) <= rho -> Rabs (a - w * right) <= rho -> Rabs w <= 2 * rho /\ Rabs a <= 3 * far * rho.
Proof.
  intros L L0 Hl Hr. assert (rho0 : 0 <= rho) by (eapply Rle_trans; [apply Rabs_pos | exact Hl]).
  assert (W : Rabs w * (right - left) <= 2 * rho).
  { rewrite <- (Rabs_pos_eq (right - left)), <- Rabs_mult by lra. apply between in Hl, Hr. apply Rabs_le. lra. }
  assert (W1 := Rmult_le_compat_l (Rabs w) 1 (right - left) (Rabs_pos w) ltac:(lra)). split; [lra |].
  assert (T := Rabs_triang (a - w * right) (w * right)). replace (a - w * right + w * right) with a in T by ring.
  rewrite Rabs_mult, (Rabs_pos_eq right) in T by lra.
  assert (G := Rmult_le_compat (Rabs w) (2 * rho) right far (Rabs_pos w) ltac:(lra) ltac:(lra) ltac:(lra)).
  assert (G2 := Rmult_le_compat_r rho 1 far rho0 ltac:(lra)). lra.
Qed.
(* So half of a hundredth of the margin's first term and half of its last are enough. *)
Definition nothing : Q := match of_nothing with Const c => c | _ => 0%Q end.
Definition least_nothing : Q := 1 # 20282409603651670423947251286016.  (* 2^-104 *)
Theorem margin_has_it rho_a rho_b E_a E_b : S = 4 * far * (rho_a + rho_b) -> 0 <= rho_a -> 0 <= rho_b ->
  / 2 ^ 92 * far <= E_a -> / 2 ^ 92 * far <= E_b ->
  of_underflow <= / 200 * (2 * (rho_a * E_b + rho_b * E_a + E_a * E_b)) + / 2 * Q2R least_nothing.
Proof.
  replace (Q2R least_nothing) with (/ 20282409603651670423947251286016) by (unfold Q2R, least_nothing; simpl; lra).
  intros S_is a0 b0 Ea Eb. unfold of_underflow. rewrite S_is. destruct h32_powers as [h hh]. set (r := rho_a + rho_b) in *.
  assert (ra := Rmult_le_compat_l rho_a _ _ a0 Eb). assert (rb := Rmult_le_compat_l rho_b _ _ b0 Ea).
  assert (Rr : 0 <= far * r) by (unfold r; apply Rmult_le_pos; lra).
  assert (EE : 0 <= E_a * E_b) by (apply Rmult_le_pos; lra).
  assert (hRr := Rmult_le_compat_r (far * r) _ _ Rr (proj2 h)).
  assert (R2 : h32 * (far * (far * r)) <= / 2 ^ 126 * (65536 * (far * r))).
  { apply Rmult_le_compat; try lra; [apply Rmult_le_pos; lra | apply Rmult_le_compat_r; lra]. }
  assert (hR : h32 * far <= / 2 ^ 126 * 65536) by (apply Rmult_le_compat; lra).
  unfold r in *. lra.
Qed.
End Edge.
Definition constants := Eval vm_compute in shown (least_bound) (bound_constant).
Print constants.
Lemma kernel_is_enough : Qle_bool least_nothing (nothing * (1 - u32Q)) = true.
Proof. vm_compute. reflexivity. Qed.
Definition rests := Eval vm_compute in shown least_nothing nothing.
Print rests.
Definition checked := (error, rho_has, margin_has_it, kernel_is_enough).
Print Assumptions checked.
