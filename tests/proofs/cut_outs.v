(* SPDX-License-Identifier: MIT *)
(* cut_outs.clh: a texture coordinate of a hit in texels, from the barycentric coordinates e and their bounds (docs/
   numerics.md, 15), in double precision; where there is none: cut_out_lanes.v.

   Assumed: the e are off by at most `bounds` together (det3_double.v, det3_float.v), the real ones have one sign and their
   sum is not 0 (the ray meets the triangle); no corner's coordinate exceeds greater_2, the largest; a quotient is off by
   2.5 ulp and by 2^-1022, as in float; the sum is 2^-800 at least (the e are multiples of 2^-447: det3_double.v); a side has
   up to 2^16 texels. Denormals may be kept or flushed: 2^-50 covers what that takes. In prose: what the texels
   and the bilinear mean do with a coordinate that is off by so much (cut_out_means.v); the corners' alpha is a quotient
   like this one; many hits at once: cut_out_lanes.v. Overflow: coordinates are at most 2^30 texels, e at most 2^390. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition e_a := 0%nat.
Definition e_b := 1%nat.
Definition e_c := 2%nat.
Definition bounds := 3%nat.
Definition u_x := 4%nat.
Definition u_y := 5%nat.
Definition u_z := 6%nat.
Definition side := 7%nat.
Definition quotient_1 := 8%nat.
Definition greater_1 := 9%nat.
Definition greater_2 := 10%nat.
Definition quotient_2 := 11%nat.
Definition sum :=
  Add (Add (Given e_a 0) (Given e_b 0)) (Given e_c 0).
Definition quotient_1_over :=
  Add (Add (Mul (Given e_a 0) (Given u_x 0)) (Mul (Given e_b 0) (Given u_y 0))) (Mul (Given e_c 0) (Given u_z 0)).
Definition quotient_1_under :=
  sum.
Definition texel :=
  Mul (Given quotient_1 5) (Given side 0).
Definition texel_rest : Q := -1 # 2.
Definition greater_1_one :=
  Abs (Given u_y 0).
Definition greater_1_other :=
  Abs (Given u_z 0).
Definition greater_2_one :=
  Abs (Given u_x 0).
Definition greater_2_other := Given greater_1 0.
Definition quotient_2_over :=
  Times (2 # 1) (Add (Given bounds 0) (Times (1 # 2251799813685248) (Add (Abs (Given e_c 0)) (Add (Abs (Given e_a
    0)) (Abs (Given e_b 0)))))).
Definition quotient_2_under :=
  Abs quotient_1_under.
Definition error :=
  Mul (Given side 0) (Mul (Given greater_2 0) (Times (4404019 # 4194304) (Add (Const (1 # 562949953421312)) (Given
    quotient_2 5)))).
Definition error_rest : Q := 5 # 4503599627370496.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation h := (/ 9007199254740992).
Definition top := quotient_1_over.

Section Hit.
Variable x : nat -> R.
Local Notation computed := (computes64_any x).
Local Notation tiny_share := (/ 1606938044258990275541962092341162602522202993782792835301376).  (* 2^-200 *)

(* The real barycentric coordinates, each off by its bound, and the hit's coordinate U. *)
Variables E_a E_b E_c B_a B_b B_c U : R.
Hypotheses (a_near : Rabs (x e_a - E_a) <= B_a) (b_near : Rabs (x e_b - E_b) <= B_b) (c_near : Rabs (x e_c - E_c) <= B_c).
Hypothesis bounds_hold : B_a + B_b + B_c <= x bounds.
Let M := x greater_2.
Hypotheses (u_x_in : Rabs (x u_x) <= M) (u_y_in : Rabs (x u_y) <= M) (u_z_in : Rabs (x u_z) <= M) (U_in : Rabs U <= M).
Hypothesis U_is : U * (E_a + E_b + E_c) = E_a * x u_x + E_b * x u_y + E_c * x u_z.
Let S := Rabs (x e_a) + Rabs (x e_b) + Rabs (x e_c).

Lemma M0 : 0 <= M.
Proof. eapply Rle_trans; [apply Rabs_pos | exact U_in]. Qed.
Lemma S0 : 0 <= S.
Proof. unfold S. repeat apply Rplus_le_le_0_compat; apply Rabs_pos. Qed.
Lemma bounds0 : 0 <= x bounds.
Proof.
  assert (P1 := Rle_trans _ _ _ (Rabs_pos _) a_near). assert (P2 := Rle_trans _ _ _ (Rabs_pos _) b_near).
  assert (P3 := Rle_trans _ _ _ (Rabs_pos _) c_near). lra.
Qed.

Lemma sum_near s : computed sum s -> Rabs (s - (E_a + E_b + E_c)) <= x bounds + 201 / 100 * h * S + 10 * h64.
Proof.
  intros C. apply near64_any in C. unfold lost64 in C. cbn -[u64 h64 alpha] in C. rewrite !u64_value in C.
  assert (A := alpha64_is_below 2 ltac:(lia)). simpl INR in A. assert (e0 := h64_positive).
  assert (P := Rmult_le_compat_r _ _ _ S0 A). unfold S in *. apply between in C. apply between in a_near.
  apply between in b_near. apply between in c_near. apply Rabs_le. lra.
Qed.

Lemma top_near t : computed top t -> Rabs (t - U * (E_a + E_b + E_c)) <= M * (x bounds + 301 / 100 * h * S) +
  h64 * (2 * S + 4 * M + 20).
Proof.
  intros C. apply near64_any in C. unfold lost64 in C. cbn -[u64 h64 alpha] in C. unfold of_product in C.
  assert (z : alpha u64 0 = 0) by (unfold alpha; simpl; lra). rewrite ?z, !u64_value in C.
  assert (A := alpha64_is_below 3 ltac:(lia)). simpl INR in A. assert (e0 := h64_positive). assert (e1 := h64_below).
  assert (m0 := M0). assert (s0 := S0). assert (Z := alpha64_at_least 3). rewrite u64_value in Z.
  assert (P : Rabs (x e_a) * Rabs (x u_x) + Rabs (x e_b) * Rabs (x u_y) + Rabs (x e_c) * Rabs (x u_z) <= S * M).
  { assert (times : forall i j, Rabs (x j) <= M -> Rabs (x i) * Rabs (x j) <= Rabs (x i) * M).
    { intros. apply Rmult_le_compat_l; auto using Rabs_pos. }
    assert (T1 := times e_a _ u_x_in). assert (T2 := times e_b _ u_y_in). assert (T3 := times e_c _ u_z_in). unfold S. lra. }
  assert (P0 : 0 <= Rabs (x e_a) * Rabs (x u_x) + Rabs (x e_b) * Rabs (x u_y) + Rabs (x e_c) * Rabs (x u_z)).
  { repeat apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos. }
  assert (G := Rmult_le_compat _ _ _ _ Z P0 A P).
  assert (moves : forall e E B j, Rabs (x e - E) <= B -> Rabs (x j) <= M -> Rabs (x e * x j - E * x j) <= B * M).
  { intros e E B j He Hj. replace (x e * x j - E * x j) with ((x e - E) * x j) by ring. rewrite Rabs_mult.
    apply Rmult_le_compat; auto using Rabs_pos. }
  assert (V1 := moves _ _ _ _ a_near u_x_in). assert (V2 := moves _ _ _ _ b_near u_y_in).
  assert (V3 := moves _ _ _ _ c_near u_z_in). rewrite U_is.
  assert (B := Rmult_le_compat_r _ _ _ m0 bounds_hold). assert (SM : 0 <= S * M) by (apply Rmult_le_pos; lra).
  assert (lm := fun j (H : Rabs (x j) <= M) => Rmult_le_compat_l h64 _ _ ltac:(lra) H).
  assert (L1 := lm _ u_x_in). assert (L2 := lm _ u_y_in). assert (L3 := lm _ u_z_in). clear lm.
  assert (hM : 0 <= h64 * M) by (apply Rmult_le_pos; lra).
  assert (hh : h64 * h64 <= h64 * / 100) by (apply Rmult_le_compat_l; lra).
  assert (s_is : h64 * S = h64 * Rabs (x e_a) + h64 * Rabs (x e_b) + h64 * Rabs (x e_c)) by (unfold S; ring).
  assert (hS0 := fun i => Rmult_le_pos _ _ (Rlt_le _ _ e0) (Rabs_pos (x i))). assert (q1 := hS0 e_a). assert (q2 := hS0 e_b).
  assert (q3 := hS0 e_c). clear hS0.
  apply between in C. apply between in V1. apply between in V2. apply between in V3. apply Rabs_le. lra.
Qed.

(* The quotient of what is computed. *)
Let D s := 2 * (x bounds + 4 * h * S) / Rabs s.
Local Notation lost_share := (/ 1267650600228229401496703205376).  (* 2^-100 *)
Theorem quotient_near s t : computed sum s -> computed top t -> s <> 0 -> h64 <= tiny_share * Rabs s ->
  4 * (x bounds + 4 * h * S) <= Rabs s ->
  Rabs (t / s - U) <= M * (2 * (x bounds + 251 / 100 * h * S) / Rabs s) + lost_share * (M + 1).
Proof.
  intros Cs Ct s0 s_least usable. assert (Ns := sum_near _ Cs). assert (Nt := top_near _ Ct). assert (m0 := M0).
  assert (p0 := S0). assert (b0 := bounds0). assert (e0 := h64_positive). assert (e1 := h64_below).
  assert (s1 := Rabs_pos_lt _ s0). assert (I := Rinv_0_lt_compat _ s1).
  assert (S_in : S <= 562949953421312 * Rabs s) by lra.
  assert (hS : h64 * S <= / 1000000000000 * lost_share * Rabs s).
  { assert (G := Rmult_le_compat_l h64 _ _ ltac:(lra) S_in). assert (G2 := Rmult_le_compat_r (Rabs s) _ _ ltac:(lra) e1). lra. }
  assert (hM : h64 * M <= tiny_share * Rabs s * M) by (apply Rmult_le_compat_r; lra).
  assert (MS0 : 0 <= Rabs s * M) by (apply Rmult_le_pos; lra).
  replace (t / s - U) with (((t - U * (E_a + E_b + E_c)) + - (U * (s - (E_a + E_b + E_c)))) * / s) by (field; auto).
  rewrite Rabs_mult, Rabs_inv.
  replace (M * (2 * (x bounds + 251 / 100 * h * S) / Rabs s) + lost_share * (M + 1)) with
    ((M * (x bounds + 301 / 100 * h * S) + M * (x bounds + 201 / 100 * h * S) + lost_share * (M + 1) * Rabs s) * / Rabs s)
    by (field; apply Rabs_no_R0; auto).
  apply Rmult_le_compat_r; [lra |].
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, Rabs_mult.
  assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) U_in Ns). lra.
Qed.

(* The coordinate in texels: the quotient, off by 5 roundings, times the side, less 1/2. The kernel's terms: 16 h, and
   2 h + 2^-50 = 10 h. *)
Definition of_side : Q := 1065 # 100.
Definition less_half := Sub texel (Const (1 # 2)).
Hypothesis side_in : 1 <= x side <= 65536.
Theorem texel_near s t v : computed sum s -> computed top t -> s <> 0 -> h64 <= tiny_share * Rabs s ->
  Rabs (x quotient_1 - t / s) <= h64 -> 4 * (x bounds + 4 * h * S) <= Rabs s -> computed less_half v ->
  Rabs (v - (U * x side - / 2)) <= x side * (M * (D s + Q2R of_side * h)) + 41 / 10 * h.
Proof.
  intros Cs Ct s0 s_least quotient usable C. assert (N := quotient_near _ _ Cs Ct s0 s_least usable).
  assert (m0 := M0). assert (p0 := S0). assert (b0 := bounds0). assert (e0 := h64_positive). assert (e1 := h64_below).
  apply near64_any in C. unfold lost64 in C. cbn -[u64 h64 alpha Q2R] in C. unfold of_product in C.
  assert (z : alpha u64 0 = 0) by (unfold alpha; simpl; lra). rewrite ?z, !u64_value in C.
  replace (Q2R (1 # 2)) with (/ 2) in C by (unfold Q2R; simpl; lra). rewrite (Rabs_pos_eq (/ 2)) in C by lra.
  rewrite (Rabs_pos_eq (x side)) in C by lra.
  assert (A := alpha64_is_below 7 ltac:(lia)). assert (A5 := alpha64_is_below 5 ltac:(lia)). simpl INR in A, A5.
  assert (Z := alpha64_at_least 7). assert (Z5 := alpha64_at_least 5). rewrite u64_value in Z, Z5.
  assert (s1 := Rabs_pos_lt _ s0). assert (I := Rinv_0_lt_compat _ s1).
  assert (hS : 0 <= h * S) by (apply Rmult_le_pos; lra).
  assert (D0 : 0 <= D s) by (unfold D, Rdiv; apply Rmult_le_pos; lra).
  assert (D_half : D s <= / 2).
  { unfold D. apply Rmult_le_reg_r with (Rabs s); auto. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra. }
  assert (D_below : M * (2 * (x bounds + 251 / 100 * h * S) / Rabs s) <= M * D s).
  { apply Rmult_le_compat_l; auto. unfold D, Rdiv. apply Rmult_le_compat_r; lra. }
  set (q := x quotient_1) in *.
  assert (N' : Rabs (q - U) <= M * D s + 2 * lost_share * (M + 1)).
  { replace (q - U) with ((q - t / s) + (t / s - U)) by ring. eapply Rle_trans; [apply Rabs_triang |].
    assert (lost_share * 1 <= lost_share * (M + 1)) by (apply Rmult_le_compat_l; lra). lra. }
  assert (MD : M * D s <= M * / 2) by (apply Rmult_le_compat_l; auto).
  assert (size : Rabs q <= 150001 / 100000 * M + 2 * lost_share).
  { replace q with ((q - U) + U) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra. }
  assert (sizes := Rmult_le_compat_r (x side) _ _ ltac:(lra) size).
  assert (Q0 : 0 <= Rabs q * x side + / 2).
  { apply Rplus_le_le_0_compat; [apply Rmult_le_pos; auto using Rabs_pos; lra | lra]. }
  assert (G := Rmult_le_compat _ _ _ _ Z Q0 A (Rplus_le_compat_r (/ 2) _ _ sizes)).
  replace (v - (U * x side - / 2)) with ((v - (q * x side - / 2)) + (q - U) * x side) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_mult, (Rabs_pos_eq (x side)) by lra.
  assert (G2 := Rmult_le_compat_r (x side) _ _ ltac:(lra) N').
  replace (Q2R of_side) with (1065 / 100) by (unfold Q2R, of_side; simpl; lra).
  assert (MS := Rmult_le_compat_l M _ _ m0 (proj1 side_in)).
  assert (hs := Rmult_le_compat_l h64 _ _ ltac:(lra) (proj2 side_in)).
  assert (hq : 0 <= (1 + alpha h 5) * Rabs q * h64 <= 2 * (150001 / 100000 * M + 2 * lost_share) * h64).
  { split; [repeat apply Rmult_le_pos; try apply Rabs_pos; lra |]. apply Rmult_le_compat_r; [lra |].
    apply Rmult_le_compat; try apply Rabs_pos; lra. }
  assert (hM : h64 * M <= lost_share * M) by (apply Rmult_le_compat_r; lra).
  assert (hh : 0 <= h64 * h64 <= h64 * / 100) by (split; [apply Rmult_le_pos | apply Rmult_le_compat_l]; lra). lra.
Qed.
End Hit.

(* The kernel's error has the same form, times 1.05, which covers its own roundings: *)
Definition inflation : Q := match error with Mul _ (Mul _ (Times i _)) => i | _ => 0%Q end.
Definition kernels_term : Q := match error with Mul _ (Mul _ (Times _ (Add (Const c) _))) => c | _ => 0%Q end.
Lemma error_is : error =
  Mul (Given side 0) (Mul (Given greater_2 0) (Times inflation (Add (Const kernels_term) (Given quotient_2 5)))) /\
  quotient_2_over = Times 2 (Add (Given bounds 0)
    (Times (1 # 2251799813685248) (Add (Abs (Given e_c 0)) (Add (Abs (Given e_a 0)) (Abs (Given e_b 0)))))).
Proof. split; reflexivity. Qed.
Lemma inflation_is_enough :
  Qle_bool 1 (inflation * (1 - alphaQ u64Q (roundings error + roundings quotient_2_over + roundings quotient_2_under))) = true /\
  Qle_bool ((41 # 10) * (1 # 9007199254740992) + (1 # 2 ^ 100)) ((1 - alphaQ u64Q 1) * error_rest) = true.
Proof. vm_compute. auto. Qed.
Definition constants := Eval vm_compute in shown (of_side * (1 # 9007199254740992))%Q kernels_term.
Print constants.
Definition checked := (quotient_near, texel_near, inflation_is_enough).
Print Assumptions checked.
