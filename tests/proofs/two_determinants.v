(* SPDX-License-Identifier: MIT *)
(* backfacing.cl: the sign of the sum of two determinants, det(u, v, a) + det(u, v, b) (docs/numerics.md, 14). The sum
  is
   certain where it exceeds 1.01 times both bounds of det3_float.v, in double 1 + 2^-6 times those of det3_double.v.

   Assumed: as in those two files: no difference exceeds 2^21 and no size is below 2^-40 (float, denormals flushed or
     not);
   in double nothing is a denormal, and where both bounds are 0 every product is (prose). Overflow: nothing exceeds
     2^67. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition u1_x := 0%nat.
Definition u1_y := 1%nat.
Definition u1_z := 2%nat.
Definition u0_x := 3%nat.
Definition u0_y := 4%nat.
Definition u0_z := 5%nat.
Definition v1_x := 6%nat.
Definition v1_y := 7%nat.
Definition v1_z := 8%nat.
Definition v0_x := 9%nat.
Definition v0_y := 10%nat.
Definition v0_z := 11%nat.
Definition a1_x := 12%nat.
Definition a1_y := 13%nat.
Definition a1_z := 14%nat.
Definition a0_x := 15%nat.
Definition a0_y := 16%nat.
Definition a0_z := 17%nat.
Definition b1_x := 18%nat.
Definition b1_y := 19%nat.
Definition b1_z := 20%nat.
Definition b0_x := 21%nat.
Definition b0_y := 22%nat.
Definition b0_z := 23%nat.
Definition one :=
  Add (Add (Mul (Diff a1_x a0_x) (Sub (Mul (Diff u1_y u0_y) (Diff v1_z v0_z)) (Mul (Diff u1_z u0_z) (Diff v1_y
    v0_y)))) (Mul (Diff a1_y a0_y) (Sub (Mul (Diff u1_z u0_z) (Diff v1_x v0_x)) (Mul (Diff u1_x u0_x) (Diff v1_z
    v0_z))))) (Mul (Diff a1_z a0_z) (Sub (Mul (Diff u1_x u0_x) (Diff v1_y v0_y)) (Mul (Diff u1_y u0_y) (Diff v1_x
    v0_x)))).
Definition other :=
  Add (Add (Mul (Diff b1_x b0_x) (Sub (Mul (Diff u1_y u0_y) (Diff v1_z v0_z)) (Mul (Diff u1_z u0_z) (Diff v1_y
    v0_y)))) (Mul (Diff b1_y b0_y) (Sub (Mul (Diff u1_z u0_z) (Diff v1_x v0_x)) (Mul (Diff u1_x u0_x) (Diff v1_z
    v0_z))))) (Mul (Diff b1_z b0_z) (Sub (Mul (Diff u1_x u0_x) (Diff v1_y v0_y)) (Mul (Diff u1_y u0_y) (Diff v1_x
    v0_x)))).
Definition size_one :=
  Add (Add (Mul (Abs (Diff a1_x a0_x)) (Add (Abs (Mul (Diff u1_y u0_y) (Diff v1_z v0_z))) (Abs (Mul (Diff u1_z u0_z)
    (Diff v1_y v0_y))))) (Mul (Abs (Diff a1_y a0_y)) (Add (Abs (Mul (Diff u1_x u0_x) (Diff v1_z v0_z))) (Abs (Mul
    (Diff u1_z u0_z) (Diff v1_x v0_x)))))) (Mul (Abs (Diff a1_z a0_z)) (Add (Abs (Mul (Diff u1_x u0_x) (Diff v1_y
    v0_y))) (Abs (Mul (Diff u1_y u0_y) (Diff v1_x v0_x))))).
Definition size_other :=
  Add (Add (Mul (Abs (Diff b1_x b0_x)) (Add (Abs (Mul (Diff u1_y u0_y) (Diff v1_z v0_z))) (Abs (Mul (Diff u1_z u0_z)
    (Diff v1_y v0_y))))) (Mul (Abs (Diff b1_y b0_y)) (Add (Abs (Mul (Diff u1_x u0_x) (Diff v1_z v0_z))) (Abs (Mul
    (Diff u1_z u0_z) (Diff v1_x v0_x)))))) (Mul (Abs (Diff b1_z b0_z)) (Add (Abs (Mul (Diff u1_x u0_x) (Diff v1_y
    v0_y))) (Abs (Mul (Diff u1_y u0_y) (Diff v1_x v0_x))))).
Definition value :=
  Add one other.
Definition bound :=
  Times (4236247 # 4194304) (Add (Times (8796093 # 17592186044416) size_one) (Times (8796093 # 17592186044416)
    size_other)).
Definition wide_one :=
  Add (Add (Mul (Abs (Diff a1_x a0_x)) (Add (Mul (Abs (Diff u1_y u0_y)) (Abs (Diff v1_z v0_z))) (Mul (Abs (Diff u1_z
    u0_z)) (Abs (Diff v1_y v0_y))))) (Mul (Abs (Diff a1_y a0_y)) (Add (Mul (Abs (Diff u1_x u0_x)) (Abs (Diff v1_z
    v0_z))) (Mul (Abs (Diff u1_z u0_z)) (Abs (Diff v1_x v0_x)))))) (Mul (Abs (Diff a1_z a0_z)) (Add (Mul (Abs (Diff
    u1_x u0_x)) (Abs (Diff v1_y v0_y))) (Mul (Abs (Diff u1_y u0_y)) (Abs (Diff v1_x v0_x))))).
Definition wide_other :=
  Add (Add (Mul (Abs (Diff b1_x b0_x)) (Add (Mul (Abs (Diff u1_y u0_y)) (Abs (Diff v1_z v0_z))) (Mul (Abs (Diff u1_z
    u0_z)) (Abs (Diff v1_y v0_y))))) (Mul (Abs (Diff b1_y b0_y)) (Add (Mul (Abs (Diff u1_x u0_x)) (Abs (Diff v1_z
    v0_z))) (Mul (Abs (Diff u1_z u0_z)) (Abs (Diff v1_x v0_x)))))) (Mul (Abs (Diff b1_z b0_z)) (Add (Mul (Abs (Diff
    u1_x u0_x)) (Abs (Diff v1_y v0_y))) (Mul (Abs (Diff u1_y u0_y)) (Abs (Diff v1_x v0_x))))).
Definition wide :=
  value.
Definition wide_bound :=
  Add (Add (Times (2535301200456459 # 2535301200456458802993406410752) wide_one) (Times (2535301200456459 #
    2535301200456458802993406410752) wide_other)) (Times (1 # 64) (Add (Times (2535301200456459 #
    2535301200456458802993406410752) wide_one) (Times (2535301200456459 # 2535301200456458802993406410752)
    wide_other))).
(* where max(abs(sub(a1_x, a0_x)), max(abs(sub(u1_x, u0_x)), abs(sub(v1_x, v0_x)))) <= 1048576.0 *)
(* where max(abs(sub(a1_y, a0_y)), max(abs(sub(u1_y, u0_y)), abs(sub(v1_y, v0_y)))) <= 1048576.0 *)
(* where max(abs(sub(a1_z, a0_z)), max(abs(sub(u1_z, u0_z)), abs(sub(v1_z, v0_z)))) <= 1048576.0 *)
(* where size_one >= 9.094947017729282e-13 *)
(* where max(abs(sub(b1_x, b0_x)), max(abs(sub(u1_x, u0_x)), abs(sub(v1_x, v0_x)))) <= 1048576.0 *)
(* where max(abs(sub(b1_y, b0_y)), max(abs(sub(u1_y, u0_y)), abs(sub(v1_y, v0_y)))) <= 1048576.0 *)
(* where max(abs(sub(b1_z, b0_z)), max(abs(sub(u1_z, u0_z)), abs(sub(v1_z, v0_z)))) <= 1048576.0 *)
(* where size_other >= 9.094947017729282e-13 *)
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation h := (/ 85070591730234615865843651857942052864).
Lemma u_is : u32 = u.
Proof. unfold u32; simpl; lra. Qed.
Lemma h_is : h32 = h.
Proof. unfold h32; simpl; lra. Qed.

Definition factor : Q := match bound with Times f _ => f | _ => 0%Q end.
Definition of_one : Q := match bound with Times _ (Add (Times c _) _) => c | _ => 0%Q end.
Lemma bound_is : bound = Times factor (Add (Times of_one size_one) (Times of_one size_other)) /\ value = Add one other.
Proof. split; reflexivity. Qed.
Definition wide_factor : Q := match wide_bound with Add _ (Times f _) => f | _ => 0%Q end.
Definition wide_of_one : Q := match wide_bound with Add (Add (Times c _) _) _ => c | _ => 0%Q end.
Definition wide_bounds := Add (Times wide_of_one wide_one) (Times wide_of_one wide_other).
Lemma wide_bound_is : wide_bound = Add wide_bounds (Times wide_factor wide_bounds) /\ wide = Add one other.
Proof. split; reflexivity. Qed.

Definition least_factor : Q := 1000001 # 1000000.
Section Float.
Variable x : nat -> R.
Let limited e := within_limits x (Q2R 0) (Q2R (2 ^ 21)) e.
Definition least : Q := 1 # 1099511627776.  (* 2^-40 *)

(* One determinant is off by at most its bound (det3_float.v). *)
Lemma one_is_near e size v s t b : e = one /\ size = size_one \/ e = other /\ size = size_other ->
  limited e -> limited size -> computes32 x e v -> computes32 x size s -> Q2R least <= s -> seen32 s t ->
  rounds32 (Q2R of_one * t) b -> Rabs (v - real x e) <= b /\ / 10000000000000000000 <= b.
Proof.
  intros which Le Ls Ce Cs S T B. split.
  - assert (u0 : 0 <= Q2R u32Q) by (rewrite u32_is; apply bpow_ge_0).
    assert (h0 : 0 <= Q2R h32Q) by (rewrite h32_is; apply bpow_ge_0).
    assert (rn : forall y w, rounds32 y w -> Rabs (w - y) <= Q2R u32Q * Rabs y + Q2R h32Q).
    { rewrite u32_is, h32_is. apply rounds32_near. }
    assert (sn : forall y w, seen32 y w -> Rabs (w - y) <= Q2R h32Q) by (rewrite h32_is; apply seen32_near).
    assert (fr : forall i, 0 <= Q2R (all h32Q i) <= Q2R h32Q) by (intros; split; [exact h0 | apply Rle_refl]).
    assert (fn : forall i k v w, (k <= 16)%nat -> Rabs (v - x i) <= alpha (Q2R u32Q) k * Rabs (x i) -> seen32 v w ->
      Rabs (w - v) <= Q2R (all h32Q i)) by (intros; now apply sn).
    unfold computes32 in *. rewrite <- u32_is in *.
    destruct which as [[-> ->] | [-> ->]]; eapply (filter_is_right u32Q h32Q (all h32Q) (all 0) (apart (2 ^ 21))
      rounds32 seen32 u0 h0 rn sn x fr fn);
      try eassumption; try (vm_compute; reflexivity);
      cbv [one other size_one size_other real permanent]; same_products.
  - apply rounds32_near in B. apply seen32_near in T. rewrite u_is, h_is in *. unfold least in S.
    replace (Q2R (1 # 1099511627776)) with (/ 1099511627776) in S by (unfold Q2R; simpl; lra).
    replace (Q2R of_one) with (8796093 / 17592186044416) in B by (unfold Q2R, of_one; simpl; lra).
    apply between in T. rewrite (Rabs_pos_eq (_ * t)) in B by lra. apply between in B. lra.
Qed.

Hypotheses (in_range : limited one /\ limited other /\ limited size_one /\ limited size_other).
Theorem sign v b : computes32 x value v -> computes32 x bound b ->
  (forall s, computes32 x size_one s \/ computes32 x size_other s -> Q2R least <= s) ->
  b < Rabs v -> (0 < v <-> 0 < real x value) /\ real x value <> 0.
Proof.
  intros C B S exceeds. destruct bound_is as [-> _] in B. destruct bound_is as [_ ->] in C |- *.
  destruct in_range as (L1 & L2 & L3 & L4).
  inversion C as [ | | | | | | ? ? p q p' q' ? Cp Cq Sp Sq R | | | ]; subst.
  inversion B as [ | | | ? ? w w' ? Cw Sw Rw | | | | | | ]; subst.
  inversion Cw as [ | | | | | | ? ? d e d' e' ? Cd Ce Sd Se Rs | | | ]; subst.
  inversion Cd as [ | | | ? ? s1 t1 ? Cs1 T1 R1 | | | | | | ]; subst.
  inversion Ce as [ | | | ? ? s2 t2 ? Cs2 T2 R2 | | | | | | ]; subst.
  destruct (one_is_near one size_one _ _ _ _ ltac:(auto) L1 L3 Cp Cs1 (S _ (or_introl Cs1)) T1 R1) as [N1 P1].
  destruct (one_is_near other size_other _ _ _ _ ltac:(auto) L2 L4 Cq Cs2 (S _ (or_intror Cs2)) T2 R2) as [N2 P2].
  apply seen32_near in Sp, Sq, Sw, Sd, Se. apply rounds32_near in R, Rw, Rs. rewrite u_is, h_is in *.
  replace (Q2R factor) with (4236247 / 4194304) in Rw by (unfold Q2R, factor; simpl; lra).
  apply between in Sp, Sq, Sw, Sd, Se, N1, N2. rewrite (Rabs_pos_eq (d' + e')) in Rs by lra. apply between in Rs.
  rewrite (Rabs_pos_eq (_ * w')) in Rw by lra. apply between in Rw. apply between in R.
  change (real x (Add one other)) with (real x one + real x other).
  unfold Rabs in *. destruct (Rcase_abs v); destruct (Rcase_abs (p' + q')); repeat split; intros; lra.
Qed.
End Float.

Section Double.
Local Notation u' := (/ 9007199254740992).
Variable x : nat -> R.
Lemma wide_is_near e size v s b : e = one /\ size = wide_one \/ e = other /\ size = wide_other ->
  within_limits x (Q2R any64) (Q2R any64) e -> within_limits x (Q2R any64) (Q2R any64) size ->
  computes64 x e v -> computes64 x size s -> 0 <= s -> rounds64 (Q2R wide_of_one * s) b -> Rabs (v - real x e) <= b.
Proof.
  intros which Le Ls Ce Cs S B.
  assert (u0 : 0 <= Q2R u64Q) by (rewrite u64_is; apply bpow_ge_0).
  assert (rn : forall y w, rounds64 y w -> Rabs (w - y) <= Q2R u64Q * Rabs y + Q2R 0).
  { rewrite u64_is, Q2R_0'. apply rounds64_near. }
  assert (sn : forall y w, seen64 y w -> Rabs (w - y) <= Q2R 0) by (rewrite Q2R_0'; apply seen64_near).
  assert (fr : forall i, 0 <= Q2R (all 0 i) <= Q2R 0) by (rewrite Q2R_0'; exact nothing_flushed_range).
  assert (fn : forall i k v w, (k <= 16)%nat -> Rabs (v - x i) <= alpha (Q2R u64Q) k * Rabs (x i) -> seen64 v w ->
    Rabs (w - v) <= Q2R (all 0 i)) by (intros; now apply nothing_flushed_near).
  unfold computes64 in *. rewrite <- u64_is in *. assert (h0 : 0 <= Q2R 0) by (rewrite Q2R_0'; lra).
  assert (S' : Q2R 0 <= s) by (rewrite Q2R_0'; exact S). assert (seen_s : seen64 s s) by reflexivity.
  destruct which as [[-> ->] | [-> ->]]; eapply (filter_is_right u64Q 0 (all 0) (all any64) (apart any64) rounds64
    seen64 u0 h0 rn sn x fr fn);
    try eassumption; try (vm_compute; reflexivity);
    cbv [one other wide_one wide_other real permanent]; same_products.
Qed.

Hypotheses (in_range : forall e, within_limits x (Q2R any64) (Q2R any64) e).
Theorem wide_sign v b : computes64 x wide v -> computes64 x wide_bound b ->
  (forall s, computes64 x wide_one s \/ computes64 x wide_other s -> 0 <= s) ->
  b < Rabs v -> (0 < v <-> 0 < real x wide) /\ real x wide <> 0.
Proof.
  intros C B S exceeds. destruct wide_bound_is as [-> _] in B. destruct wide_bound_is as [_ ->] in C |- *.
  inversion C as [ | | | | | | ? ? p q p' q' ? Cp Cq Sp Sq R | | | ]; subst. unfold seen64 in Sp, Sq. subst p' q'.
  inversion B as [ | | | | | | ? ? w z w' z' ? Cw Cz Sw Sz Rb | | | ]; subst. unfold seen64 in Sw, Sz. subst w' z'.
  inversion Cz as [ | | | ? ? y y' ? Cy Sy Ry | | | | | | ]; subst. unfold seen64 in Sy. subst y'.
  assert (bounds : forall d, computes64 x wide_bounds d -> exists B1 B2, 0 <= B1 /\ 0 <= B2 /\ Rabs (p - real x one) <=
    B1 /\
    Rabs (q - real x other) <= B2 /\ Rabs (d - (B1 + B2)) <= u' * (B1 + B2)).
  { intros d Cd. inversion Cd as [ | | | | | | ? ? e f e' f' ? Ce Cf Se Sf Rs | | | ]; subst. unfold seen64 in Se, Sf.
  subst e' f'.
    inversion Ce as [ | | | ? ? s1 t1 ? Cs1 T1 R1 | | | | | | ]; subst.
    inversion Cf as [ | | | ? ? s2 t2 ? Cs2 T2 R2 | | | | | | ]; subst.
    unfold seen64 in T1, T2. subst t1 t2. exists e, f.
    assert (N1 := wide_is_near one wide_one _ _ _ ltac:(auto) (in_range _) (in_range _) Cp Cs1 (S _ (or_introl Cs1))
      R1).
    assert (N2 := wide_is_near other wide_other _ _ _ ltac:(auto) (in_range _) (in_range _) Cq Cs2 (S _ (or_intror Cs2))
      R2).
    assert (e0 := Rle_trans _ _ _ (Rabs_pos _) N1). assert (f0 := Rle_trans _ _ _ (Rabs_pos _) N2).
    apply rounds64_near in Rs. replace u64 with u' in Rs by (unfold u64; simpl; lra).
    rewrite (Rabs_pos_eq (e + f)) in Rs by lra. repeat split; auto; lra. }
  destruct (bounds _ Cw) as (B1 & B2 & P1 & P2 & N1 & N2 & Nw).
  destruct (bounds _ Cy) as (B3 & B4 & P3 & P4 & N3 & N4 & Ny).
  apply rounds64_near in R, Rb, Ry. replace u64 with u' in * by (unfold u64; simpl; lra).
  replace (Q2R wide_factor) with (/ 64) in Ry by (unfold Q2R, wide_factor; simpl; lra).
  apply between in Nw, Ny, N1, N2, N3, N4. assert (y0 : 0 <= y) by lra. assert (w0 : 0 <= w) by lra.
  rewrite (Rabs_pos_eq (_ * y)) in Ry by lra. apply between in Ry. assert (z0 : 0 <= z) by lra.
  rewrite (Rabs_pos_eq (w + z)) in Rb by lra. apply between in Rb. apply between in R.
  change (real x (Add one other)) with (real x one + real x other).
  unfold Rabs in *. destruct (Rcase_abs v); destruct (Rcase_abs (p + q)); destruct (Rle_dec ((B1 + B2) / 2) (B3 + B4));
    repeat split; intros; lra.
Qed.
End Double.

(* From these factors on sign and wide_sign hold: the roundings of the sum, of the bounds' sum and of the product. *)
Definition least_wide : Q := 1 + (6 # 9007199254740992).
Lemma kernels_are_enough : (factor >= least_factor /\ 1 + wide_factor >= least_wide)%Q.
Proof. vm_compute. split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_factor factor.
Print constants.
Definition rests := Eval vm_compute in shown least_wide (1 + wide_factor).
Print rests.
Definition checked := (sign, wide_sign, kernels_are_enough).
Print Assumptions checked.
