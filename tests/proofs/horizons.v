(* SPDX-License-Identifier: MIT *)
(* strip_triangle.clh: twice the area of two corners and the point, in a strip's coordinates (beside()), against
   2^-19 times the product of their distances |x| + |y| + FIELD_NEAR.

   Assumed: a sector's vectors are unit vectors times `halves`, off by two roundings, and 0 or no denormals;
   `halves` is at most 2^41 (FIELD_LEAST_CELL: 2^35), no distance above 2^20 half cells. Denormals may be kept or flushed. *)
From Coq Require Import Reals QArith Lia Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition b_x := 2%nat.
Definition b_y := 3%nat.
Definition at_x := 4%nat.
Definition at_y := 5%nat.
Definition halves := 6%nat.
Definition sector_0_0 := 7%nat.
Definition sector_0_1 := 8%nat.
Definition sector_1_0 := 9%nat.
Definition sector_1_1 := 10%nat.
Definition value :=
  Fma (Fma (Given sector_0_0 2) (Diff a_x at_x) (Mul (Given sector_0_1 2) (Diff a_y at_y))) (Fma (Given sector_1_0
    2) (Diff b_x at_x) (Mul (Given sector_1_1 2) (Diff b_y at_y))) (Mul (Fma (Given sector_0_0 2) (Diff b_x at_x)
    (Mul (Given sector_0_1 2) (Diff b_y at_y))) (Neg (Fma (Given sector_1_0 2) (Diff a_x at_x) (Mul (Given
    sector_1_1 2) (Diff a_y at_y))))).
Definition size :=
  Mul (Add (Const (1 # 1099511627776)) (Mul (Add (Abs (Diff a_x at_x)) (Abs (Diff a_y at_y))) (Given halves 0)))
    (Add (Const (1 # 1099511627776)) (Mul (Add (Abs (Diff b_x at_x)) (Abs (Diff b_y at_y))) (Given halves 0))).
Definition bound :=
  Mul (Add (Const (1 # 1099511627776)) (Mul (Add (Abs (Diff b_x at_x)) (Abs (Diff b_y at_y))) (Given halves 0)))
    (Times (1 # 524288) (Add (Const (1 # 1099511627776)) (Mul (Add (Abs (Diff a_x at_x)) (Abs (Diff a_y at_y)))
    (Given halves 0)))).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation l := (/ 2417851639229258349412352).  (* 2^-81: what underflow takes of a coordinate *)
Local Notation e := (/ 1099511627776).  (* FIELD_NEAR *)
Definition near_rest : Q := 1 # 1099511627776.
Definition kernels_constant : Q := 1 # 524288.
Definition distance_of x_of y_of := Add (Const near_rest) (Mul (Add (Abs (Diff x_of at_x)) (Abs (Diff y_of at_y)))
  (Given halves 0)).
Lemma bound_is : bound = Mul (distance_of b_x b_y) (Times kernels_constant (distance_of a_x a_y)) /\
  size = Mul (distance_of a_x a_y) (distance_of b_x b_y).
Proof. split; reflexivity. Qed.
Definition along s t x_of y_of := Fma (Given s 2) (Diff x_of at_x) (Mul (Given t 2) (Diff y_of at_y)).
Lemma value_is : value = Fma (along sector_0_0 sector_0_1 a_x a_y) (along sector_1_0 sector_1_1 b_x b_y)
  (Mul (along sector_0_0 sector_0_1 b_x b_y) (Neg (along sector_1_0 sector_1_1 a_x a_y))).
Proof. reflexivity. Qed.

Section Area.
Variable x : nat -> R.
Let H := x halves.
Hypotheses (along_x : Rabs (x sector_0_0) <= H) (along_y : Rabs (x sector_0_1) <= H).
Hypotheses (across_x : Rabs (x sector_1_0) <= H) (across_y : Rabs (x sector_1_1) <= H) (H_in : H <= 2199023255552).
(* The sector's numbers are 0 or no denormals. *)
Definition may_lose (i : nat) : Q := if Nat.leb halves i then 0 else h32Q.
Hypothesis sector_is_normal : forall i, (halves <= i)%nat -> x i = 0 \/ 2 * h32 <= Rabs (x i).
Lemma sector_keeps : keeps x may_lose.
Proof.
  intros i. unfold may_lose. destruct (Nat.leb_spec halves i); [right | now left]. split; [reflexivity |].
  now apply sector_is_normal.
Qed.
Lemma H0 : 0 <= H.
Proof. eapply Rle_trans; [apply Rabs_pos | exact along_x]. Qed.

(* A real distance, without FIELD_NEAR. *)
Definition d i j := (Rabs (x i - x at_x) + Rabs (x j - x at_y)) * H.
Lemma d0 i j : 0 <= d i j.
Proof. apply Rmult_le_pos; [apply Rplus_le_le_0_compat; apply Rabs_pos | exact H0]. Qed.

Lemma along_near s t i j v : (halves <= s)%nat -> (halves <= t)%nat ->
  Rabs (x s) <= H -> Rabs (x t) <= H -> computes32 x (along s t i j) v ->
  Rabs (v - real x (along s t i j)) <= 501 / 100 * u * d i j + l /\ Rabs (real x (along s t i j)) <= d i j.
Proof.
  intros Hs' Ht' Hs Ht C.
  assert (K := computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near seen32_near x
    (fun i => Q2R (may_lose i)) (keeps_range x _ sector_keeps) (keeps_near x _ sector_keeps) _ v C).
  assert (Ps : Q2R (may_lose s) = 0).
  { unfold may_lose. rewrite (proj2 (Nat.leb_le _ _) Hs'). apply Q2R_0'. }
  assert (Pt : Q2R (may_lose t) = 0).
  { unfold may_lose. rewrite (proj2 (Nat.leb_le _ _) Ht'). apply Q2R_0'. }
  assert (A := alpha_below 5 ltac:(lia)). simpl INR in A. assert (h := h32_positive). assert (h1 := h32_below). simpl
    in h1.
  unfold along in K |- *. cbn -[u32 h32 alpha may_lose] in K |- *. rewrite Ps, Pt in K. unfold of_product in K.
  set (p := Rabs (x i - x at_x)) in *. set (q := Rabs (x j - x at_y)) in *.
  assert (p0 : 0 <= p) by apply Rabs_pos. assert (q0 : 0 <= q) by apply Rabs_pos.
  assert (G1 := Rmult_le_compat_r p _ _ p0 Hs). assert (G2 := Rmult_le_compat_r q _ _ q0 Ht).
  assert (Z1 : 0 <= Rabs (x s) * p) by (apply Rmult_le_pos; auto using Rabs_pos).
  assert (Z2 : 0 <= Rabs (x t) * q) by (apply Rmult_le_pos; auto using Rabs_pos).
  assert (D : d i j = H * p + H * q) by (unfold d; fold p q; ring).
  split.
  - assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 5) (Rplus_le_le_0_compat _ _ Z1 Z2) A
      (Rplus_le_compat _ _ _ _ G1 G2)). rewrite u32_value in E.
    assert (A2 : 0 <= alpha u32 2 <= / 1000) by (split; [apply alpha_at_least | assert (B := alpha_below 2
      ltac:(lia)); simpl INR in B; lra]).
    rewrite u32_value in K.
    assert (F : forall y, Rabs (x y) <= H -> 0 <= (1 + alpha (/ 16777216) 2) * Rabs (x y) * ((1 + / 16777216) * (2 *
      h32) + h32 + h32)
      <= 2199023255552 * 5 * h32).
    { rewrite u32_value in A2. intros y Hy. assert (y0 := Rabs_pos (x y)). split.
      - repeat apply Rmult_le_pos; lra.
      - assert (B : (1 + alpha (/ 16777216) 2) * Rabs (x y) <= (1 + / 1000) * 2199023255552) by (apply
        Rmult_le_compat; lra).
        assert (B' := Rmult_le_compat_r ((1 + / 16777216) * (2 * h32) + h32 + h32) _ _ ltac:(lra) B). lra. }
    assert (F1 := F _ Hs). assert (F2 := F _ Ht). rewrite D. lra.
  - eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult. fold p q. rewrite D. lra.
Qed.

Lemma product_near A a B b p q : 0 <= p <= 1048576 -> 0 <= q <= 1048576 -> Rabs a <= p -> Rabs b <= q ->
  Rabs (A - a) <= 501 / 100 * u * p + l -> Rabs (B - b) <= 501 / 100 * u * q + l ->
  Rabs (A * B - a * b) <= 1003 / 100 * u * (p * q) + 101 / 100 * l * (p + q) + l * l /\ Rabs A <= 1048577 /\ Rabs B <=
    1048577 /\
  Rabs (A * B) <= 1001 / 1000 * (p * q) + 101 / 100 * l * (p + q) + l * l.
Proof.
  intros p0 q0 Ha Hb HA HB. assert (pq : 0 <= p * q) by (apply Rmult_le_pos; lra).
  assert (A1 : Rabs A <= (1 + 501 / 100 * u) * p + l).
  { assert (T := Rabs_triang (A - a) a). replace (A - a + a) with A in T by ring. lra. }
  assert (B1 : Rabs B <= (1 + 501 / 100 * u) * q + l).
  { assert (T := Rabs_triang (B - b) b). replace (B - b + b) with B in T by ring. lra. }
  repeat split; try lra.
  - replace (A * B - a * b) with ((A - a) * B + a * (B - b)) by ring. eapply Rle_trans; [apply Rabs_triang |].
    rewrite !Rabs_mult. assert (G1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) HA B1).
    assert (G2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Ha HB). lra.
  - rewrite Rabs_mult. assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) A1 B1). lra.
Qed.

Lemma distance_near i j v : computes32 x (distance_of i j) v -> (1 - 402 / 100 * u) * (d i j + e) <= v <= (1 + 402 /
  100 * u) * (d i j + e).
Proof.
  intros C. assert (K := computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near
    seen32_near x
    (fun i => Q2R (may_lose i)) (keeps_range x _ sector_keeps) (keeps_near x _ sector_keeps) _ v C).
  assert (A := alpha_below 4 ltac:(lia)). simpl INR in A. assert (h := h32_positive). assert (h1 := h32_below). simpl
    in h1.
  unfold distance_of in K. cbn -[u32 h32 alpha may_lose Q2R] in K. replace (Q2R (may_lose halves)) with 0 in K
    by (unfold may_lose; simpl; now rewrite Q2R_0').
  replace (Q2R near_rest) with e in K by (unfold Q2R, near_rest; simpl; lra). unfold of_product in K. fold H in K.
  assert (Z := H0). rewrite (Rabs_pos_eq e), (Rabs_pos_eq H), ?Rabs_Rabsolu in K by lra. rewrite ?u32_value in *.
  replace (alpha u 0) with 0 in K by (unfold alpha; simpl; lra).
  assert (D0 := d0 i j). assert (E := Rmult_le_compat_r (d i j + e) _ _ ltac:(lra) A).
  set (w := (1 + u) * ((1 + u) * (2 * h32) + h32 + h32 + h32 + ((1 + u) * (2 * h32) + h32 + h32 + h32)) + h32 + h32)
    in *.
  assert (W : 0 <= H * w <= 2199023255552 * 14 * h32).
  { split; [unfold w; apply Rmult_le_pos; lra |].
    assert (G := Rmult_le_compat_r w _ _ ltac:(unfold w; lra) H_in). unfold w in *. lra. }
  unfold d in *. apply between in K. unfold w in *. lra.
Qed.

Definition least_bound : Q := 242 # 167772160.
Theorem error v b c : computes32 x value v -> computes32 x (Mul (distance_of b_x b_y) (Times c (distance_of a_x a_y)))
  b ->
  Q2R least_bound <= Q2R c * (1 - 11 * u) -> Q2R c <= 1 -> d a_x a_y <= 1048575 -> d b_x b_y <= 1048575 ->
  Rabs (v - real x value) <= b.
Proof.
  intros Cv Cb Hc c1 da_in db_in. rewrite value_is in Cv |- *. assert (h := h32_positive). assert (h1 := h32_below).
    simpl in h1.
  destruct (step32_fma _ _ _ _ _ Cv) as (A & B & m & CA & CB & Cm & N1).
  destruct (step32_mul _ _ _ _ Cm) as (C & D' & CC & CD' & N2). destruct (step32_neg _ _ _ CD') as (D & CD & N3).
  apply along_near in CA as [A1 A2]; [| unfold halves, sector_0_0, sector_0_1; lia .. | assumption | assumption].
  apply along_near in CB as [B1 B2]; [| unfold halves, sector_1_0, sector_1_1; lia .. | assumption | assumption].
  apply along_near in CC as [C1 C2]; [| unfold halves, sector_0_0, sector_0_1; lia .. | assumption | assumption].
  apply along_near in CD as [D1 D2]; [| unfold halves, sector_1_0, sector_1_1; lia .. | assumption | assumption].
  cbn [real].
  set (a0 := real x (along sector_0_0 sector_0_1 a_x a_y)) in *. set (b0 := real x (along sector_1_0 sector_1_1 b_x
    b_y)) in *.
  set (c0 := real x (along sector_0_0 sector_0_1 b_x b_y)) in *. set (d0' := real x (along sector_1_0 sector_1_1 a_x
    a_y)) in *.
  set (p := d a_x a_y) in *. set (q := d b_x b_y) in *. assert (p0 : 0 <= p) by apply d0. assert (q0 : 0 <= q) by
    apply d0.
  destruct (product_near A a0 B b0 p q ltac:(lra) ltac:(lra) A2 B2 A1 B1) as (P1 & P2 & P3 & P4).
  destruct (product_near C c0 D d0' q p ltac:(lra) ltac:(lra) C2 D2 C1 D1) as (Q1 & Q2 & Q3 & Q4).
  assert (D'_in : Rabs D' <= 1048578).
  { assert (T := Rabs_triang (D' + D) (- D)). rewrite Rabs_Ropp in T. replace (D' + D + - D) with D' in T by ring.
    lra. }
  assert (CD'_near : Rabs (C * D' + C * D) <= 1048577 * h32).
  { replace (C * D' + C * D) with (C * (D' + D)) by ring. rewrite Rabs_mult.
    apply Rmult_le_compat; auto using Rabs_pos. }
  assert (CD'_in : Rabs (C * D') <= Rabs (C * D) + 1048577 * h32).
  { assert (T := Rabs_triang (C * D' + C * D) (- (C * D))). rewrite Rabs_Ropp in T.
    replace (C * D' + C * D + - (C * D)) with (C * D') in T by ring. lra. }
  assert (M2 : 2 * h32 * (Rabs C + Rabs D' + 1) <= 2 * h32 * 2097157) by (apply Rmult_le_compat_l; lra).
  assert (M1 : 2 * h32 * (Rabs A + Rabs B + 2) <= 2 * h32 * 2097157) by (apply Rmult_le_compat_l; lra).
  assert (m_in : Rabs m <= (1 + u) * Rabs (C * D') + 2 * h32 * 2097157).
  { assert (T := Rabs_triang (m - C * D') (C * D')). replace (m - C * D' + C * D') with m in T by ring. lra. }
  assert (S := Rabs_triang (A * B) m).
  assert (N2' : Rabs (m - C * D') <= u * Rabs (C * D') + 2 * h32 * 2097157) by lra.
  assert (N1' : Rabs (v - (A * B + m)) <= u * (Rabs (A * B) + Rabs m) + 2 * h32 * 2097157) by lra. clear N1 N2 M1 M2 S.
  assert (pq : 0 <= p * q) by (apply Rmult_le_pos; lra).
  (* The bound. *)
  destruct (step32_mul _ _ _ _ Cb) as (db & t & Cdb & Ct & Nb). destruct (step32_times _ _ _ _ Ct) as (da & Cda & Nt).
  apply distance_near in Cda, Cdb. fold p in Cda. fold q in Cdb.
  replace (Q2R least_bound) with (242 / 10 * u) in Hc by (unfold Q2R, least_bound; simpl; lra).
  assert (c0' : 0 <= Q2R c) by lra. rewrite (Rabs_pos_eq (Q2R c)) in Nt by lra.
  assert (cda0 : 0 <= Q2R c * da) by (apply Rmult_le_pos; lra). rewrite (Rabs_pos_eq (Q2R c * da)) in Nt by lra.
  assert (hc : 2 * h32 * (Q2R c + 1) <= 4 * h32) by (assert (G := Rmult_le_compat_l (2 * h32) _ _ ltac:(lra) c1); lra).
  assert (cda1 := Rmult_le_compat_r da _ _ ltac:(lra) c1). apply between in Nt.
  assert (t_low : Q2R c * da * (1 - u) - 4 * h32 <= t) by lra. assert (t_in : Rabs t <= 1048578) by (apply Rabs_le;
    lra).
  assert (db_in' : 0 <= db <= 1048577) by lra.
  assert (tb : db * (Q2R c * da * (1 - u) - 4 * h32) <= db * t) by (apply Rmult_le_compat_l; lra).
  assert (hd := Rmult_le_compat_l h32 _ _ ltac:(lra) (proj2 db_in')).
  assert (nn : Rabs (db * t) <= db * t + 2 * 1048577 * 4 * h32).
  { assert (Z : 0 <= db * (Q2R c * da * (1 - u))) by (apply Rmult_le_pos; [lra | apply Rmult_le_pos; lra]).
    apply Rabs_le. lra. }
  assert (M3 : 2 * h32 * (Rabs db + Rabs t + 1) <= 2 * h32 * 2097157).
  { rewrite (Rabs_pos_eq db) by lra. apply Rmult_le_compat_l; lra. }
  apply between in Nb.
  set (s := (q + e) * (p + e)) in *. assert (s0 : 0 <= s) by (unfold s; apply Rmult_le_pos; lra).
  assert (w : (1 - 402 / 100 * u) * (1 - 402 / 100 * u) * s <= db * da).
  { assert (W := Rmult_le_compat ((1 - 402 / 100 * u) * (q + e)) db ((1 - 402 / 100 * u) * (p + e)) da ltac:(lra)
    ltac:(lra)
      (proj1 Cdb) (proj1 Cda)). unfold s. lra. }
  assert (cw := Rmult_le_compat_l (Q2R c) _ _ c0' w).
  assert (cs := Rmult_le_compat_r s _ _ s0 Hc).
  assert (cs0 : 0 <= Q2R c * s) by (apply Rmult_le_pos; lra).
  assert (b_large : 2419 / 100 * u * s - 20000000 * h32 <= b) by lra.
  assert (s_is : s = p * q + e * (p + q) + e * e) by (unfold s; ring).
  clear Nb nn tb cw cs w Nt t_low t_in hd M3.
  replace (v - (a0 * b0 + c0 * - d0')) with ((v - (A * B + m)) + ((A * B - a0 * b0) + ((m - C * D') + ((C * D' + C *
    D) + - (C * D - c0 * d0')))))
    by ring.
  eapply Rle_trans; [apply Rabs_triang |].
  assert (T1 := Rabs_triang (A * B - a0 * b0) ((m - C * D') + ((C * D' + C * D) + - (C * D - c0 * d0')))).
  assert (T2 := Rabs_triang (m - C * D') ((C * D' + C * D) + - (C * D - c0 * d0'))).
  assert (T3 := Rabs_triang (C * D' + C * D) (- (C * D - c0 * d0'))). rewrite Rabs_Ropp in T3. lra.
Qed.
End Area.
Lemma kernel_is_enough : (least_bound <= kernels_constant * (1 - 11 * u32Q) /\ kernels_constant <= 1)%Q.
Proof. vm_compute. split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_bound kernels_constant.
Print constants.
Definition checked := (bound_is, error, kernel_is_enough).
Print Assumptions checked.
