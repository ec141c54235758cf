(* SPDX-License-Identifier: MIT *)
(* cut_outs.clh: the bilinear mean of a cell's four texels times the corners' alpha, and bounds of that alpha (docs/numerics.md,
   15), in double precision; cut_out_means_float.v has the same in float.
     mean_near, product_near   the mean, and its product with an alpha, from coordinates that are off by their errors;
     alpha_is_between          `low` and `high`, even after one more product, enclose the real alpha.

   Assumed: texels are whole numbers up to 255; both coordinates, real and computed, lie in the cell; the alpha is off by at
   most alpha_error (cut_outs.v, with a side of 1) and from 0 to 1; alpha_error is 2^-51 at least, and 2^-52 of it is left, as the kernel adds 2^-50 and underflow takes 2^-97.
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
  Times (257 # 1) (Add (Add (Add (Given error_x 0) (Given error_y 0)) (Const (1 # 562949953421312))) (Given off 0)).
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
  Times (2 # 1) (Add (Given bounds 0) (Times (1 # 2251799813685248) (Add (Abs (Given e_c 0)) (Add (Abs (Given e_a
    0)) (Abs (Given e_b 0)))))).
Definition quotient_2_under :=
  Abs quotient_1_under.
Definition alpha_error :=
  Mul (Given greater_2 0) (Times (4404019 # 4194304) (Add (Const (1 # 562949953421312)) (Given quotient_2 5))).
Definition alpha_error_rest : Q := 1 # 1125899906842624.
Definition low :=
  Times (2251799813685247 # 2251799813685248) (Sub (Given quotient_1 5) (Add (Const (1 # 1125899906842624))
    alpha_error)).
Definition high :=
  Times (2251799813685249 # 2251799813685248) (Add (Add (Const (1 # 1125899906842624)) alpha_error) (Given
    quotient_1 5)).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation h := (/ 9007199254740992).
Definition half_ulp : Q := 1 # 9007199254740992.
Local Notation computed := computes64_any.
Local Notation few := (/ 1427247692705959881058285969449495136382746624).  (* 2^-150, more than underflow takes *)
Lemma given_is x i v : computed x (Given i 0) v -> v = x i.
Proof.
  intros C. inversion C as [ | ? ? ? H | | | | | | | | ]; subst.
  assert (Z : alpha u64 0 = 0) by (unfold alpha; simpl pow; ring). rewrite Z, Rmult_0_l in H. apply between in H. lra.
Qed.
Lemma after_sum p q s t v : seen64_any p s -> seen64_any q t -> rounds64_any (s + t) v ->
  Rabs (v - (p + q)) <= h * Rabs (p + q) + few.
Proof.
  intros P Q R. apply seen64_any_near in P, Q. apply rounds64_any_near in R. rewrite u64_value in R.
  assert (e0 := h64_positive). assert (e1 := h64_below).
  assert (T : Rabs (s + t - (p + q)) <= 2 * h64).
  { replace (s + t - (p + q)) with ((s - p) + (t - q)) by ring. eapply Rle_trans; [apply Rabs_triang | lra]. }
  assert (T1 := Rabs_triang (s + t - (p + q)) (p + q)). replace (s + t - (p + q) + (p + q)) with (s + t) in T1 by ring.
  replace (v - (p + q)) with ((v - (s + t)) + (s + t - (p + q))) by ring. eapply Rle_trans; [apply Rabs_triang | lra].
Qed.
Lemma after_difference p q s t v : seen64_any p s -> seen64_any q t -> rounds64_any (s - t) v ->
  Rabs (v - (p - q)) <= h * Rabs (p - q) + few.
Proof.
  intros P Q R. apply (after_sum p (- q) s (- t)); auto.
  destruct Q as [-> | [Q ->]]; [left; ring | right; rewrite Rabs_Ropp; split; [exact Q | ring]].
Qed.
Lemma after_product p q s t v : seen64_any p s -> seen64_any q t -> rounds64_any (s * t) v -> Rabs p <= 1000000 ->
  Rabs q <= 1000000 -> Rabs (v - p * q) <= h * Rabs (p * q) + few.
Proof.
  intros P Q R Hp Hq. apply seen64_any_near in P, Q. apply rounds64_any_near in R. rewrite u64_value in R.
  assert (e0 := h64_positive). assert (e1 := h64_below).
  assert (T : Rabs (s * t - p * q) <= 3000000 * h64).
  { replace (s * t - p * q) with ((s - p) * q + ((t - q) * p + (s - p) * (t - q))) by ring.
    assert (A := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) P Hq).
    assert (B := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Q Hp).
    assert (C := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) P Q). rewrite <- !Rabs_mult in A, B, C.
    assert (hh : h64 * h64 <= h64 * / 100) by (apply Rmult_le_compat_l; lra).
    eapply Rle_trans; [apply Rabs_triang |]. assert (E := Rabs_triang ((t - q) * p) ((s - p) * (t - q))). lra. }
  assert (T1 := Rabs_triang (s * t - p * q) (p * q)). replace (s * t - p * q + p * q) with (s * t) in T1 by ring.
  replace (v - p * q) with ((v - s * t) + (s * t - p * q)) by ring. eapply Rle_trans; [apply Rabs_triang | lra].
Qed.
Lemma diff_near x i j v : computed x (Diff i j) v -> Rabs (v - (x i - x j)) <= h * Rabs (x i - x j) + few.
Proof. intros C. inversion C; subst. eapply after_difference; eassumption. Qed.
Lemma add_near x a b v : computed x (Add a b) v -> exists p q, computed x a p /\ computed x b q /\
  Rabs (v - (p + q)) <= h * Rabs (p + q) + few.
Proof. intros C. inversion C; subst. do 2 eexists. repeat split; try eassumption. eapply after_sum; eassumption. Qed.
Lemma sub_near x a b v : computed x (Sub a b) v -> exists p q, computed x a p /\ computed x b q /\
  Rabs (v - (p - q)) <= h * Rabs (p - q) + few.
Proof. intros C. inversion C; subst. do 2 eexists. repeat split; try eassumption. eapply after_difference; eassumption. Qed.
Lemma mul_near x a b v : computed x (Mul a b) v -> exists p q, computed x a p /\ computed x b q /\
  (Rabs p <= 1000000 -> Rabs q <= 1000000 -> Rabs (v - p * q) <= h * Rabs (p * q) + few).
Proof. intros C. inversion C; subst. do 2 eexists. repeat split; try eassumption. intros. eapply after_product; eassumption. Qed.
Lemma times_near x q a v : computed x (Times q a) v -> exists p, computed x a p /\
  (Rabs (Q2R q) <= 1000000 -> Rabs (v - Q2R q * p) <= h * Rabs (Q2R q * p) + few).
Proof.
  intros C. inversion C as [ | | | ? ? p s ? Hp Hs R | | | | | | ]; subst. exists p. split; [exact Hp |]. intros small.
  apply seen64_any_near in Hs. apply rounds64_any_near in R. rewrite u64_value in R.
  assert (e0 := h64_positive). assert (e1 := h64_below).
  assert (T : Rabs (Q2R q * s - Q2R q * p) <= 1000000 * h64).
  { rewrite <- Rmult_minus_distr_l, Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos. }
  assert (T1 := Rabs_triang (Q2R q * s - Q2R q * p) (Q2R q * p)).
  replace (Q2R q * s - Q2R q * p + Q2R q * p) with (Q2R q * s) in T1 by ring.
  replace (v - Q2R q * p) with ((v - Q2R q * s) + (Q2R q * s - Q2R q * p)) by ring.
  eapply Rle_trans; [apply Rabs_triang | lra].
Qed.

Load cut_out_means_body.
