(* SPDX-License-Identifier: MIT *)
(* cut_outs.clh: the bilinear mean of a cell's four texels times the corners' alpha, and bounds of that alpha (docs/numerics.md,
   15), where there is no double precision; cut_out_means.v has the same in double.
     mean_near, product_near   the mean, and its product with an alpha, from coordinates that are off by their errors;
     alpha_is_between          `low` and `high`, even after one more product, enclose the real alpha.

   Assumed: texels are whole numbers up to 255; both coordinates, real and computed, lie in the cell; the alpha is off by at
   most alpha_error (cut_out_lanes.v, alpha_near) and from 0 to 1; alpha_error is 2^-51 at least, and 2^-52 of it is left, as the
   kernel adds 2^-50 and underflow takes 2^-61; a cell's first texel is below 2^24, as a coordinate from 2^20 on is off by more
   than half a texel.
   Denormals may be kept or flushed. A float is the same wherever it is used: `upper` and alpha_error are inputs of their own.
   In prose: the
   difference from the threshold rounds once, which changes no sign. Overflow: nothing exceeds 2^18. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition at_x := 0%nat.
Definition first_x := 1%nat.
Definition error_x := 2%nat.
Definition at_y := 3%nat.
Definition first_y := 4%nat.
Definition error_y := 5%nat.
Definition off := 6%nat.
Definition texels_x := 7%nat.
Definition texels_y := 8%nat.
Definition texels_z := 9%nat.
Definition texels_w := 10%nat.
Definition e_a := 11%nat.
Definition e_b := 12%nat.
Definition e_c := 13%nat.
Definition bounds := 14%nat.
Definition alphas_x := 15%nat.
Definition alphas_y := 16%nat.
Definition alphas_z := 17%nat.
Definition quotient_1 := 18%nat.
Definition greater_1 := 19%nat.
Definition greater_2 := 20%nat.
Definition quotient_2 := 21%nat.
Definition mean :=
  Add (Add (Given texels_x 0) (Mul (Diff at_x first_x) (Diff texels_y texels_x))) (Mul (Sub (Add (Given texels_z 0)
    (Mul (Diff at_x first_x) (Diff texels_w texels_z))) (Add (Given texels_x 0) (Mul (Diff at_x first_x) (Diff
    texels_y texels_x)))) (Diff at_y first_y)).
Definition error :=
  Times (257 # 1) (Add (Add (Add (Given error_x 0) (Given error_y 0)) (Const (1 # 1048576))) (Given off 0)).
Definition quotient_1_over :=
  Add (Add (Mul (Given alphas_x 0) (Given e_a 0)) (Mul (Given alphas_y 0) (Given e_b 0))) (Mul (Given alphas_z 0)
    (Given e_c 0)).
Definition quotient_1_under :=
  Add (Add (Given e_a 0) (Given e_b 0)) (Given e_c 0).
Definition of_hit := Given quotient_1 5.
Definition greater_1_one :=
  Abs (Given alphas_y 0).
Definition greater_1_other :=
  Abs (Given alphas_z 0).
Definition greater_2_one :=
  Abs (Given alphas_x 0).
Definition greater_2_other := Given greater_1 0.
Definition quotient_2_over :=
  Times (2 # 1) (Add (Given bounds 0) (Times (1 # 4194304) (Add (Abs (Given e_c 0)) (Add (Abs (Given e_a 0)) (Abs
    (Given e_b 0)))))).
Definition quotient_2_under :=
  Abs quotient_1_under.
Definition alpha_error :=
  Mul (Given greater_2 0) (Times (4404019 # 4194304) (Add (Const (1 # 1048576)) (Given quotient_2 5))).
Definition alpha_error_rest : Q := 1 # 1125899906842624.
Definition low :=
  Times (4194303 # 4194304) (Sub (Given quotient_1 5) (Add (Const (1 # 1125899906842624)) alpha_error)).
Definition high :=
  Times (4194305 # 4194304) (Add (Add (Const (1 # 1125899906842624)) alpha_error) (Given quotient_1 5)).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation h := (/ 16777216).
Definition half_ulp : Q := u32Q.
Local Notation computed := computes32.
Local Notation few := (/ 1267650600228229401496703205376).  (* 2^-100, more than underflow takes *)
Lemma few_is : 3000004 * h32 <= few.
Proof. assert (H := h32_below). simpl in H. lra. Qed.
Lemma given_is x i v : computed x (Given i 0) v -> v = x i.
Proof. apply given32_is. Qed.
Lemma diff_near x i j v : computed x (Diff i j) v -> Rabs (v - (x i - x j)) <= h * Rabs (x i - x j) + few.
Proof. intros C. apply step32_diff in C. assert (F := few_is). assert (0 < h32) by apply h32_positive. lra. Qed.
Lemma add_near x a b v : computed x (Add a b) v -> exists p q, computed x a p /\ computed x b q /\
  Rabs (v - (p + q)) <= h * Rabs (p + q) + few.
Proof.
  intros C. destruct (step32_add _ _ _ _ C) as (p & q & Cp & Cq & N). exists p, q. assert (F := few_is).
  assert (0 < h32) by apply h32_positive. repeat split; auto. lra.
Qed.
Lemma sub_near x a b v : computed x (Sub a b) v -> exists p q, computed x a p /\ computed x b q /\
  Rabs (v - (p - q)) <= h * Rabs (p - q) + few.
Proof.
  intros C. destruct (step32_sub _ _ _ _ C) as (p & q & Cp & Cq & N). exists p, q. assert (F := few_is).
  assert (0 < h32) by apply h32_positive. repeat split; auto. lra.
Qed.
Lemma times_few a : a <= 1500002 -> 2 * h32 * a <= few.
Proof.
  intros A. assert (F := few_is). assert (0 < h32) by apply h32_positive.
  assert (G := Rmult_le_compat_l (2 * h32) _ _ ltac:(lra) A). lra.
Qed.
Lemma mul_near x a b v : computed x (Mul a b) v -> exists p q, computed x a p /\ computed x b q /\
  (Rabs p <= 500000 -> Rabs q <= 1000000 -> Rabs (v - p * q) <= h * Rabs (p * q) + few).
Proof.
  intros C. destruct (step32_mul _ _ _ _ C) as (p & q & Cp & Cq & N). exists p, q. repeat split; auto. intros.
  assert (T := times_few (Rabs p + Rabs q + 1) ltac:(lra)). lra.
Qed.
Lemma times_near x q a v : computed x (Times q a) v -> exists p, computed x a p /\
  (Rabs (Q2R q) <= 1000000 -> Rabs (v - Q2R q * p) <= h * Rabs (Q2R q * p) + few).
Proof.
  intros C. destruct (step32_times _ _ _ _ C) as (p & Cp & N). exists p. split; auto. intros.
  assert (T := times_few (Rabs (Q2R q) + 1) ltac:(lra)). lra.
Qed.

Load cut_out_means_body.
