(* SPDX-License-Identifier: MIT *)
(* camera_rays.clh: 1 / t of a hit, N / D, of which two orders follow (docs/numerics.md, 9).
     wide_is_near           a determinant that is good in double is within 2^-30 of itself, one from the accumulator
        nearer;
     nearness_is_near       so nearness() is within 2^-29 of 1 / t;
     interval_contains_it   the float interval contains every such value, so that disjoint intervals have its order.

   Assumed: the determinants are off by at most their bounds (det3_double.v, camera_rays.v), in float by at most a
   quarter of themselves; a float quotient is off by 2.5 ulp, a double one is rounded to nearest; 1 / t is at least
   2^-60, as a ray's largest coordinate is at least 2^-30 and the float level is used up to differences of 2^20.
   Denormals may be kept or flushed; doubles are never that small. Overflow: values are at most 2^63, their
   quotients 2^125. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition along := 0%nat.
Definition depth := 1%nat.
Definition along_bound := 2%nat.
Definition depth_bound := 3%nat.
Definition wide := 4%nat.
Definition quotient_1 := 5%nat.
Definition quotient_2 := 6%nat.
Definition quotient_3 := 7%nat.
Definition wide_error :=
  Times (4352132950612665 # 4835703278458516698824704) (Abs (Given wide 0)).
Definition quotient_1_over := Given along 0.
Definition quotient_1_under := Given depth 0.
Definition value := Given quotient_1 5.
Definition quotient_2_over := Given along_bound 0.
Definition quotient_2_under :=
  Abs (Given along 0).
Definition of_along := Given quotient_2 5.
Definition quotient_3_over := Given depth_bound 0.
Definition quotient_3_under :=
  Abs (Given depth 0).
Definition of_depth := Given quotient_3 5.
Definition error :=
  Mul (Abs (Given quotient_1 5)) (Add (Const (8796093 # 17592186044416)) (Times (11744051 # 8388608) (Add (Given
    quotient_2 5) (Given quotient_3 5)))).
Definition low :=
  Sub (Given quotient_1 5) error.
Definition high :=
  Add (Given quotient_1 5) error.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation h := (/ 9007199254740992).
Local Notation k := (/ 1073741824).

(* ---- In double ---- *)
Definition good : Q := match wide_error with Times c _ => c | _ => 0%Q end.
Definition of_good : Q := good * (1 + u64Q) / (1 - good * (1 + u64Q)).
Lemma good_is_enough : (of_good <= 1 # 1073741824)%Q.
Proof. vm_compute. discriminate. Qed.
Lemma relative v V e : 0 <= e < 1 -> Rabs (v - V) <= e * Rabs v -> Rabs (v - V) <= e / (1 - e) * Rabs V.
Proof.
  intros E H. assert (T := Rabs_triang_inv v (v - V)). replace (v - (v - V)) with V in T by ring.
  assert (Hv : Rabs v <= / (1 - e) * Rabs V).
  { apply Rmult_le_reg_l with (1 - e); [lra |]. rewrite <- Rmult_assoc, Rinv_r, Rmult_1_l by lra. lra. }
  assert (G := Rmult_le_compat_l e _ _ ltac:(lra) Hv). unfold Rdiv. lra.
Qed.
Theorem wide_is_near v V bound limit : Rabs (v - V) <= bound -> bound <= limit -> Rabs (limit - Q2R good * Rabs v) <=
  h *
  Rabs (Q2R good * Rabs v) ->
  Rabs (v - V) <= / 1073741824 * Rabs V.
Proof.
  intros H K L. assert (v0 := Rabs_pos v). replace (Q2R good) with (4352132950612665 / 4835703278458516698824704) in L
    by (unfold Q2R, good; simpl; lra).
  rewrite (Rabs_pos_eq (_ * Rabs v)) in L by (apply Rmult_le_pos; lra). apply between in L.
  assert (N : Rabs (v - V) <= 90000001 / 100000000000000000 * Rabs v) by lra.
  apply relative in N; [| lra]. assert (V0 := Rabs_pos V). lra.
Qed.
Theorem nearness_is_near n d N D w : D <> 0 -> Rabs (n - N) <= / 1073741824 * Rabs N -> Rabs (d - D) <= / 1073741824 *
  Rabs D ->
  Rabs (w - n / d) <= h * Rabs (n / d) -> Rabs (w - N / D) <= 101 / 100 * / 536870912 * Rabs (N / D).
Proof.
  intros D0 Hn Hd Hw.
  assert (P := Rabs_pos_lt _ D0). assert (T := Rabs_triang_inv D (D - d)). replace (D - (D - d)) with d in T by ring.
  rewrite (Rabs_minus_sym D) in T. assert (T' : (1 - k) * Rabs D <= Rabs d) by lra.
  assert (d0 : d <> 0) by (intros Z; rewrite Z, Rabs_R0 in T'; lra).
  assert (I : Rabs (/ d) <= 10001 / 10000 * Rabs (/ D)).
  { rewrite !Rabs_inv. apply Rmult_le_reg_l with (Rabs d); [now apply Rabs_pos_lt |].
  rewrite Rinv_r by (apply Rabs_no_R0; auto).
    apply Rmult_le_reg_r with (Rabs D); auto. rewrite !Rmult_assoc, Rinv_l by (apply Rabs_no_R0; auto). lra. }
  assert (E : Rabs (n / d - N / D) <= 2001 / 1000 * k * Rabs (N / D)).
  { replace (n / d - N / D) with ((n - N) * / d + - (N / D * ((d - D) * / d))) by (field; auto).
    eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, !(Rabs_mult _ (/ d)), (Rabs_mult (N / D)), !(Rabs_mult _
      (/ d)).
    assert (G1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Hn I).
    assert (G2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Hd I).
    replace (k * Rabs D * (10001 / 10000 * Rabs (/ D))) with (k * (10001 / 10000)) in G2
      by (rewrite Rabs_inv; field; apply Rabs_no_R0; auto).
    replace (k * Rabs N * (10001 / 10000 * Rabs (/ D))) with (k * (10001 / 10000) * Rabs (N / D)) in G1
      by (unfold Rdiv; rewrite Rabs_mult; ring).
    assert (G3 := Rmult_le_compat_l _ _ _ (Rabs_pos (N / D)) G2). assert (Z := Rabs_pos (N / D)).
    rewrite <- !Rabs_mult in *. lra. }
  assert (T2 := Rabs_triang (n / d - N / D) (N / D)). replace (n / d - N / D + N / D) with (n / d) in T2 by ring.
  assert (Z := Rabs_pos (N / D)). replace (w - N / D) with ((w - n / d) + (n / d - N / D)) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. lra.
Qed.

(* ---- In float ---- *)
Definition of_both : Q := match error with Mul _ (Add _ (Times c _)) => c | _ => 0%Q end.
Definition of_rest : Q := match error with Mul _ (Add (Const c) _) => c | _ => 0%Q end.
Lemma error_is :
  error = Mul (Abs (Given quotient_1 5)) (Add (Const of_rest) (Times of_both (Add (Given quotient_2 5) (Given quotient_3
    5)))) /\
  low = Sub (Given quotient_1 5) error /\ high = Add (Given quotient_1 5) error.
Proof. repeat split; reflexivity. Qed.
(* The same with floats z, a and b, and the error e as an input of the ends. *)
Definition shared := 99%nat.
Definition error_of c r := Mul (Abs (Given quotient_1 0)) (Add (Const r) (Times c (Add (Given quotient_2 0) (Given
  quotient_3 0)))).
Definition low_of := Sub (Given quotient_1 0) (Given shared 0).
Definition high_of := Add (Given quotient_1 0) (Given shared 0).

Section Interval.
Variable x : nat -> R.
Let n := x along. Let d := x depth. Let z := x quotient_1. Let a := x quotient_2. Let b := x quotient_3. Let e := x
  shared.
Variables N D w : R.
Hypotheses (n0 : n <> 0) (d0 : d <> 0).
Hypotheses (n_near : Rabs (n - N) <= x along_bound) (d_near : Rabs (d - D) <= x depth_bound).
Hypotheses (n_usable : 4 * x along_bound <= Rabs n) (d_usable : 4 * x depth_bound <= Rabs d).
Let off q s t := Rabs (q - s / t) <= 501 / 100 * u * Rabs (s / t).
Hypotheses (z_is : off z n d) (a_is : off a (x along_bound) (Rabs n)) (b_is : off b (x depth_bound) (Rabs d)).
Hypothesis w_near : Rabs (w - N / D) <= 101 / 100 * / 536870912 * Rabs (N / D).
Hypothesis z_in : / 1152921504606846976 <= Rabs z.

Definition least_both : Q := 133335 # 100000.
Definition least_rest : Q := 69 # 167772160.
Variables c r : Q.
Hypotheses (c_in : Q2R least_both <= Q2R c <= 141 / 100) (r_in : Q2R least_rest <= Q2R r <= 100 * u).

Let caps i := if Nat.eqb i quotient_1 then line 0 1 else number 1.
Let gaps (i j : nat) := number 0.
Theorem interval_contains_it l m : not_above (underflowP (all h32Q) caps gaps (error_of c r)) (line tiny tiny) = true ->
  computes32 x (error_of c r) e -> computes32 x low_of l -> computes32 x high_of m -> l <= w
  <= m.
Proof.
  intros U Ce Cl Ck.
  assert (A1 := Rabs_pos_lt _ n0). assert (D1 := Rabs_pos_lt _ d0). set (q := Rabs (n / d)) in *.
  set (A := x along_bound / Rabs n). set (B := x depth_bound / Rabs d).
  assert (bn := Rle_trans _ _ _ (Rabs_pos _) n_near). assert (bd := Rle_trans _ _ _ (Rabs_pos _) d_near).
  assert (quarter : forall s t, 0 < t -> 0 <= s -> 4 * s <= t -> 0 <= s / t <= / 4).
  { intros s t t0 s0 H. assert (I := Rinv_0_lt_compat _ t0). split; [unfold Rdiv; apply Rmult_le_pos; lra |].
    apply Rmult_le_reg_r with t; auto. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  assert (A_in := quarter _ _ A1 bn n_usable). assert (B_in := quarter _ _ D1 bd d_usable). fold A in A_in.
  fold B in B_in. clear quarter.
  unfold off in *. fold A in a_is. fold B in b_is. fold q in z_is.
  rewrite (Rabs_pos_eq A) in a_is by lra. rewrite (Rabs_pos_eq B) in b_is by lra. apply between in a_is, b_is.
  (* The real quotient. *)
  assert (N_rel : Rabs (n - N) = Rabs ((n - N) / n) * Rabs n) by (rewrite <- Rabs_mult; f_equal; field; auto).
  assert (D_rel : Rabs (d - D) = Rabs ((d - D) / d) * Rabs d) by (rewrite <- Rabs_mult; f_equal; field; auto).
  set (s := (n - N) / n) in *. set (t := (d - D) / d) in *.
  assert (s_in : Rabs s <= A) by (apply Rmult_le_reg_r with (Rabs n); auto; unfold A; unfold Rdiv; rewrite Rmult_assoc,
    Rinv_l by lra; lra).
  assert (t_in : Rabs t <= B) by (apply Rmult_le_reg_r with (Rabs d); auto; unfold B; unfold Rdiv; rewrite Rmult_assoc,
    Rinv_l by lra; lra).
  assert (t_b := between _ _ t_in).
  assert (D_is : D = d * (1 - t)) by (unfold t; field; auto). assert (N_is : N = n * (1 - s)) by (unfold s; field;
    auto).
  assert (t1 : 1 - t <> 0) by lra.
  assert (real : Rabs (N / D - n / d) <= 4 / 3 * (A + B) * q).
  { rewrite N_is, D_is. replace (n * (1 - s) / (d * (1 - t)) - n / d) with (n / d * ((t - s) * / (1 - t))) by (field;
    auto).
    rewrite !Rabs_mult. fold q. assert (I : Rabs (/ (1 - t)) <= 4 / 3).
    { rewrite Rabs_pos_eq by (left; apply Rinv_0_lt_compat; lra). replace (4 / 3) with (/ (3 / 4)) by field.
    apply Rinv_le_contravar; lra. }
    assert (S : Rabs (t - s) <= A + B) by (assert (T := Rabs_triang t (- s)); rewrite Rabs_Ropp in T; unfold Rminus;
      lra).
    assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) S I).
    assert (G2 := Rmult_le_compat_l q _ _ (Rabs_pos _) G). lra. }
  assert (q0 : 0 <= q) by apply Rabs_pos. assert (T := Rabs_triang (N / D - n / d) (n / d)).
  replace (N / D - n / d + n / d) with (N / D) in T by ring. fold q in T.
  assert (qA : 0 <= A * q <= / 4 * q) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra).
  assert (qB : 0 <= B * q <= / 4 * q) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra).
  assert (w_off : Rabs (w - z) <= (502 / 100 * u + 6 / 100 * u) * q + 4 / 3 * (A * q + B * q)).
  { replace (w - z) with ((w - N / D) + ((N / D - n / d) + - (z - n / d))) by ring. eapply Rle_trans; [apply
    Rabs_triang |].
    assert (T2 := Rabs_triang (N / D - n / d) (- (z - n / d))). rewrite Rabs_Ropp in T2. lra. }
  assert (z_size : (1 - 501 / 100 * u) * q <= Rabs z <= (1 + 501 / 100 * u) * q).
  { assert (T2 := Rabs_triang_inv (n / d) (n / d - z)). replace (n / d - (n / d - z)) with z in T2 by ring.
    assert (T3 := Rabs_triang (z - n / d) (n / d)). replace (z - n / d + n / d) with z in T3 by ring.
    rewrite (Rabs_minus_sym (n / d)) in T2. fold q in T2, T3. lra. }
  (* The error. *)
  apply (near_at_size x caps gaps (Rabs z) (line tiny tiny)) in Ce;
    [| lra | exact U | unfold a, b, z in *; within_sizes; rewrite Rabs_pos_eq; lra].
  unfold line in Ce. cbn [at_size] in Ce. rewrite tiny_is in Ce. cbn -[u32 alpha Q2R] in Ce. fold z a b in Ce.
  assert (F := alpha_below 4 ltac:(lia)). simpl INR in F.
  replace (Q2R least_both) with (133335 / 100000) in c_in by (unfold Q2R, least_both; simpl; lra).
  replace (Q2R least_rest) with (69 / 10 * u) in r_in by (unfold Q2R, least_rest; simpl; lra).
  rewrite (Rabs_pos_eq (Q2R c)), (Rabs_pos_eq (Q2R r)), (Rabs_pos_eq a), (Rabs_pos_eq b) in Ce by lra.
  set (Y := Q2R r + Q2R c * (a + b)) in *.
  assert (ca : 0 <= Q2R c * (a + b)) by (apply Rmult_le_pos; lra).
  assert (ca1 := Rmult_le_compat (Q2R c) (141 / 100) (a + b) (501 / 1000) ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)).
  assert (ca2 := Rmult_le_compat_r (a + b) (133335 / 100000) (Q2R c) ltac:(lra) ltac:(lra)).
  assert (Y_in : 69 / 10 * u + 133334 / 100000 * (A + B) <= Y <= 71 / 100) by (unfold Y; lra).
  assert (z0 := Rabs_pos z). assert (zY0 : 0 <= Rabs z * Y) by (apply Rmult_le_pos; lra).
  assert (E := Rmult_le_compat_r _ _ _ zY0 F). apply between in Ce.
  assert (zY : (1 - 501 / 100 * u) * q * (69 / 10 * u + 133334 / 100000 * (A + B)) <= Rabs z * Y) by (apply
    Rmult_le_compat; lra || (apply Rmult_le_pos; lra)).
  assert (zY1 : Rabs z * Y <= Rabs z * (71 / 100)) by (apply Rmult_le_compat_l; lra).
  (* The ends. *)
  destruct (step32_sub _ _ _ _ Cl) as (z1 & e1 & C1 & C2 & L). apply given32_is in C1, C2. subst z1 e1. fold z e in L.
  destruct (step32_add _ _ _ _ Ck) as (z1 & e1 & C1 & C2 & K). apply given32_is in C1, C2. subst z1 e1. fold z e in K.
  assert (z_b := between _ _ (Rle_refl (Rabs z))).
  assert (L1 : Rabs (z - e) <= 172 / 100 * Rabs z) by (apply Rabs_le; lra).
  assert (K1 : Rabs (z + e) <= 172 / 100 * Rabs z) by (apply Rabs_le; lra).
  assert (h1 := h32_below). simpl in h1. apply (at_most32 _ _ _ _ L) in L1. apply (at_most32 _ _ _ _ K) in K1. apply
    between in L1, K1, w_off. split; lra.
Qed.
End Interval.

Lemma underflow_is_little : not_above (underflowP (all h32Q) (fun i => if Nat.eqb i quotient_1 then line 0 1 else
  number 1)
  (fun _ _ => number 0) (error_of of_both of_rest)) (line tiny tiny) = true.
Proof. vm_compute. reflexivity. Qed.
Lemma kernels_are_enough : (least_both <= of_both /\ of_both <= 141 # 100 /\ least_rest <= of_rest /\ of_rest <= 100 *
  u32Q)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_rest of_rest.
Print constants.
Definition rests := Eval vm_compute in shown (Qred of_good) (1 # 1073741824).
Print rests.
Definition checked := (good_is_enough, wide_is_near, nearness_is_near, interval_contains_it, underflow_is_little,
  kernels_are_enough).
Print Assumptions checked.
