(* SPDX-License-Identifier: MIT *)
(* A filter compares |value| with a computed bound, constant * size, where size is the value's permanent as the kernel
   computes it, and at least `least`. Where the constant is not below least_constant, the value is off by at most the
   bound (filter_is_right), so that a value beyond it has the sign of the real value (sign_is_right).

   Numbers are rationals here, so that Coq computes them. *)
From Coq Require Import List Reals QArith Qreals Qabs Lia Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices.

(* Roundings.v's numbers, in rationals: as an operand, input i loses at most f i; it is at
   most m i, the difference of inputs i and j at most d i j. *)
Section Rationals.
Open Scope Q_scope.
Variables u h : Q.
Variable f : nat -> Q.
Variable m : nat -> Q.
Variable d : nat -> nat -> Q.
Fixpoint powerQ (k : nat) : Q := match k with O => 1 | S k => Qred ((1 + u) * powerQ k) end.
Definition alphaQ k := powerQ k - 1.
Fixpoint largestQ (e : expr) : Q :=
  match e with
  | Const q => Qabs q
  | Given i _ => m i
  | Diff i j => d i j
  | Times q a => Qred (Qabs q * largestQ a)
  | Neg a | Abs a => largestQ a
  | Add a b | Sub a b => Qred (largestQ a + largestQ b)
  | Mul a b => Qred (largestQ a * largestQ b)
  | Fma a b c => Qred (largestQ a * largestQ b + largestQ c)
  end.
Definition of_productQ (a b A B p q : Q) := (1 + a) * A * q + (1 + b) * B * p + p * q.
Definition gapQ (e : expr) := match e with Given i k => if Nat.leb k 16 then f i else h | _ => h end.
Fixpoint underflowQ (e : expr) : Q :=
  match e with
  | Const _ | Given _ _ => 0
  | Diff _ _ => Qred ((1 + u) * (2 * h) + h)
  | Times q a => Qred ((1 + u) * (Qabs q * (underflowQ a + gapQ a)) + h)
  | Neg a | Abs a => Qred (underflowQ a + gapQ a)
  | Add a b | Sub a b => Qred ((1 + u) * (underflowQ a + gapQ a + (underflowQ b + gapQ b)) + h)
  | Mul a b =>
      Qred ((1 + u) * of_productQ (alphaQ (roundings a)) (alphaQ (roundings b)) (largestQ a) (largestQ b)
                        (underflowQ a + gapQ a) (underflowQ b + gapQ b) + h)
  | Fma a b c =>
      Qred ((1 + u) * (of_productQ (alphaQ (roundings a)) (alphaQ (roundings b)) (largestQ a) (largestQ b)
                         (underflowQ a + gapQ a) (underflowQ b + gapQ b) + underflowQ c + gapQ c) + h)
  end.

(* Where one limit serves all inputs, and one all differences. *)
Definition all (limit : Q) (i : nat) := limit.
Definition apart (limit : Q) (i j : nat) := limit.

(* The error per size, and the least constant for sizes from `least` on. *)
Definition rate (value size : expr) := Qred (alphaQ (roundings value) / (1 - alphaQ (roundings size))).
Definition least_constant (value size : expr) (least : Q) :=
  if Qle_bool least h then rate value size / (1 - u)
  else Qred ((rate value size * (least + underflowQ size) + underflowQ value + h) / ((1 - u) * (least - h))).
Definition is_enough (value size : expr) (least constant : Q) :=
  let A := rate value size in
  let C := constant * (1 - u) in
  Qle_bool 0 least && Qle_bool 0 constant && Qle_bool u 1 && Qle_bool h least &&
  negb (Qle_bool 1 (alphaQ (roundings size))) && Qle_bool A C &&
  Qle_bool (A * (least + underflowQ size) + underflowQ value + h) (C * (least - h)).
Definition is_within (value size : expr) (constant rest : Q) :=
  let A := rate value size in
  negb (Qle_bool 1 (alphaQ (roundings size))) && Qle_bool A constant &&
  Qle_bool (A * underflowQ size + underflowQ value) rest.
Definition least_rest (value size : expr) := Qred (rate value size * underflowQ size + underflowQ value).
End Rationals.

Open Scope R_scope.

Lemma Q2R_red q : Q2R (Qred q) = Q2R q.
Proof. apply Qeq_eqR, Qred_correct. Qed.
Lemma Q2R_1 : Q2R 1 = 1.
Proof. unfold Q2R; simpl; lra. Qed.
Lemma Q2R_0' : Q2R 0 = 0.
Proof. unfold Q2R; simpl; lra. Qed.
Lemma Q2R_2 : Q2R 2 = 2.
Proof. unfold Q2R; simpl; lra. Qed.

Lemma between y b : Rabs y <= b -> - b <= y <= b.
Proof. unfold Rabs; destruct (Rcase_abs y); lra. Qed.

Lemma Q2R_abs q : Q2R (Qabs q) = Rabs (Q2R q).
Proof.
  apply Qabs_case; intros H; apply Qle_Rle in H; rewrite Q2R_0' in H.
  - now rewrite Rabs_pos_eq.
  - rewrite Q2R_opp. now rewrite Rabs_left1.
Qed.

Ltac to_reals :=
  repeat (rewrite Q2R_red || rewrite Q2R_plus || rewrite Q2R_minus || rewrite Q2R_mult || rewrite Q2R_1 || rewrite
    Q2R_2 ||
          rewrite Q2R_0').

Section Reals.
Variables u h : Q.
Variable f : nat -> Q.
Let F i := Q2R (f i).
Variable m : nat -> Q.
Variable d : nat -> nat -> Q.
Let M i := Q2R (m i).
Let D i j := Q2R (d i j).
Lemma power_is k : Q2R (powerQ u k) = (1 + Q2R u) ^ k.
Proof. induction k; cbn [powerQ pow]; to_reals; [reflexivity | now rewrite IHk]. Qed.
Lemma alpha_is k : Q2R (alphaQ u k) = alpha (Q2R u) k.
Proof. unfold alphaQ, alpha. to_reals. now rewrite power_is. Qed.
Lemma largest_is e : Q2R (largestQ m d e) = largest M D e.
Proof. induction e; cbn [largestQ largest]; to_reals; rewrite ?Q2R_abs; try reflexivity; congruence. Qed.
Lemma underflow_is e : Q2R (underflowQ u h f m d e) = underflow (Q2R u) (Q2R h) F M D e.
Proof.
  assert (G : forall e, Q2R (gapQ h f e) = gap (Q2R h) F e) by
    (intros []; simpl; try destruct (Nat.leb k 16); reflexivity).
  induction e; cbn [underflowQ underflow]; unfold of_productQ, of_product; to_reals; rewrite ?alpha_is, ?largest_is,
    ?Q2R_abs, ?IHe, ?IHe1, ?IHe2, ?IHe3,
    ?G; reflexivity.
Qed.
End Reals.

Section Filter.
Variables u h : Q.
Variable f : nat -> Q.
Let F i := Q2R (f i).
Variable m : nat -> Q.
Variable d : nat -> nat -> Q.
Let M i := Q2R (m i).
Let D i j := Q2R (d i j).
Variables rounds seen : R -> R -> Prop.
Hypotheses (u0 : 0 <= Q2R u) (h0 : 0 <= Q2R h).
Hypothesis rounds_near : forall s v, rounds s v -> Rabs (v - s) <= Q2R u * Rabs s + Q2R h.
Hypothesis seen_near : forall v w, seen v w -> Rabs (w - v) <= Q2R h.
Variable x : nat -> R.
Hypothesis flushed_range : forall i, 0 <= F i <= Q2R h.
Hypothesis flushed_near : forall i k v w, (k <= 16)%nat -> Rabs (v - x i) <= alpha (Q2R u) k * Rabs (x i) -> seen v w
  -> Rabs (w - v) <= F i.
Let computed := computes (Q2R u) rounds seen x.
Let limited := within x M D.

Theorem filter_is_right value size least constant v s t b :
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  is_enough u h f m d value size least constant = true ->
  computed value v -> computed size s -> Q2R least <= s -> seen s t -> rounds (Q2R constant * t) b ->
  Rabs (v - real x value) <= b.
Proof.
  intros Lv Ls Hp Hs E Cv Cs Hleast Ht Hb.
  unfold is_enough in E. rewrite !Bool.andb_true_iff, Bool.negb_true_iff in E.
  destruct E as [[[[[[E1 E2] E3] E4] E5] E6] E7].
  apply Qle_bool_imp_le, Qle_Rle in E1, E2, E3, E4, E6, E7.
  assert (E5' : (alphaQ u (roundings size) < 1)%Q).
  { apply Qnot_le_lt. intro H. apply Qle_bool_iff in H. congruence. }
  assert (E5'' := Qlt_Rlt _ _ E5'). rewrite alpha_is, Q2R_1 in E5''.
  assert (Nv := computed_is_near (Q2R u) (Q2R h) u0 h0 rounds seen rounds_near seen_near x F flushed_range
    flushed_near M D value v Lv Cv).
  assert (Ns := computed_is_near (Q2R u) (Q2R h) u0 h0 rounds seen rounds_near seen_near x F flushed_range
    flushed_near M D size s Ls Cs).
  assert (Av := alpha_positive (Q2R u) u0 (roundings value)).
  assert (As := alpha_positive (Q2R u) u0 (roundings size)).
  assert (U := underflow_positive (Q2R u) (Q2R h) u0 h0 x F flushed_range M D size Ls).
  unfold rate in *. rewrite ?Q2R_red in *.
  assert (nonzero : ~ (1 - alphaQ u (roundings size) == 0)%Q).
  { intro H. assert (H' : (alphaQ u (roundings size) == 1)%Q) by (rewrite <- Qplus_0_r, <- H; ring).
    rewrite H' in E5'. now apply Qlt_irrefl in E5'. }
  repeat rewrite Q2R_mult in E6. repeat rewrite Q2R_mult in E7.
  rewrite ?Q2R_plus, ?Q2R_minus, ?Q2R_mult, ?Q2R_1, ?Q2R_red in *.
  rewrite ?Q2R_div, ?Q2R_minus, ?Q2R_1, ?alpha_is in E6, E7 by exact nonzero.
  rewrite Q2R_plus in E7. rewrite !underflow_is in E7. fold F M D in E7. rewrite Q2R_0' in E1, E2.
  rewrite Hs in Ns. assert (HPs : alpha (Q2R u) (roundings value) * permanent x value <=
    alpha (Q2R u) (roundings value) * permanent x size) by (now apply Rmult_le_compat_l).
  set (P := permanent x size) in *. set (a := alpha (Q2R u) (roundings value)) in *.
  set (g := alpha (Q2R u) (roundings size)) in *. set (Us := underflow _ _ _ _ _ size) in *.
  set (Uv := underflow _ _ _ _ _ value) in *. set (A := a / (1 - g)) in *.
  apply between in Ns.
  assert (HP : a * P <= A * (s + Us)).
  { unfold A. replace (a * P) with (a / (1 - g) * ((1 - g) * P)) by (field; lra).
    apply Rmult_le_compat_l; [| lra]. unfold Rdiv. apply Rmult_le_pos; auto. left; apply Rinv_0_lt_compat; lra. }
  apply seen_near in Ht. apply between in Ht. apply rounds_near in Hb. apply between in Hb.
  assert (T0 : 0 <= t) by lra.
  assert (CT : 0 <= Q2R constant * t) by (apply Rmult_le_pos; lra).
  rewrite (Rabs_pos_eq (Q2R constant * t)) in Hb by exact CT.
  set (C := Q2R constant * (1 - Q2R u)) in *.
  assert (C0 : 0 <= C) by (unfold C; apply Rmult_le_pos; lra).
  assert (Hb' : C * t - Q2R h <= b) by (unfold C; lra).
  assert (Ct : C * (s - Q2R h) <= C * t) by (apply Rmult_le_compat_l; lra).
  assert (grow : (C - A) * Q2R least <= (C - A) * s) by (apply Rmult_le_compat_l; lra).
  lra.
Qed.

(* Where a kernel adds further terms to the error, or is to err by at most a given rest: the error is at most constant
  s +
   rest. *)
Theorem error_is_below value size constant rest v s :
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  is_within u h f m d value size constant rest = true ->
  computed value v -> computed size s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s + Q2R rest.
Proof.
  intros Lv Ls Hp Hs E Cv Cs Hs0. unfold is_within in E. rewrite !Bool.andb_true_iff, Bool.negb_true_iff in E.
  destruct E as [[E5 E6] E7]. apply Qle_bool_imp_le, Qle_Rle in E6, E7.
  assert (E5' : (alphaQ u (roundings size) < 1)%Q).
  { apply Qnot_le_lt. intro H. apply Qle_bool_iff in H. congruence. }
  assert (E5'' := Qlt_Rlt _ _ E5'). rewrite alpha_is, Q2R_1 in E5''.
  assert (Nv := computed_is_near (Q2R u) (Q2R h) u0 h0 rounds seen rounds_near seen_near x F flushed_range
    flushed_near M D value v Lv Cv).
  assert (Ns := computed_is_near (Q2R u) (Q2R h) u0 h0 rounds seen rounds_near seen_near x F flushed_range
    flushed_near M D size s Ls Cs).
  assert (Av := alpha_positive (Q2R u) u0 (roundings value)).
  unfold rate in *. assert (nonzero : ~ (1 - alphaQ u (roundings size) == 0)%Q).
  { intro H. assert (H' : (alphaQ u (roundings size) == 1)%Q) by (rewrite <- Qplus_0_r, <- H; ring).
    rewrite H' in E5'. now apply Qlt_irrefl in E5'. }
  rewrite Q2R_plus, Q2R_mult in E7. rewrite Q2R_red, Q2R_div, Q2R_minus, Q2R_1, !alpha_is in E6, E7 by exact nonzero.
  rewrite !underflow_is in E7. fold F M D in E7. rewrite Hs in Ns. apply between in Ns.
  assert (HPs : alpha (Q2R u) (roundings value) * permanent x value <=
    alpha (Q2R u) (roundings value) * permanent x size) by (now apply Rmult_le_compat_l).
  set (P := permanent x size) in *. set (a := alpha (Q2R u) (roundings value)) in *.
  set (g := alpha (Q2R u) (roundings size)) in *. set (Us := underflow _ _ _ _ _ size) in *.
  set (Uv := underflow _ _ _ _ _ value) in *. set (A := a / (1 - g)) in *.
  assert (HP : a * P <= A * (s + Us)).
  { unfold A. replace (a * P) with (a / (1 - g) * ((1 - g) * P)) by (field; lra).
    apply Rmult_le_compat_l; [| lra]. unfold Rdiv. apply Rmult_le_pos; auto. left; apply Rinv_0_lt_compat; lra. }
  assert (A * s <= Q2R constant * s) by (apply Rmult_le_compat_r; lra). lra.
Qed.

Corollary sign_is_right value size least constant v s t b :
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  is_enough u h f m d value size least constant = true ->
  computed value v -> computed size s -> Q2R least <= s -> seen s t -> rounds (Q2R constant * t) b ->
  b < Rabs v -> (0 < v <-> 0 < real x value) /\ real x value <> 0.
Proof.
  intros. assert (E : Rabs (v - real x value) <= b) by (eapply filter_is_right; eassumption).
  apply between in E. unfold Rabs in *. destruct (Rcase_abs v); repeat split; intros; lra.
Qed.
End Filter.

(* ---- The devices of Devices.v ------------------------------------------------------------------------------------ *)

Definition u32Q : Q := 1 # 2 ^ 24.
Definition h32Q : Q := 1 # 2 ^ 126.
Definition u64Q : Q := 1 # 2 ^ 53.

Lemma u32_is : Q2R u32Q = u32.
Proof. unfold Q2R, u32Q, u32, bpow; rewrite Rmult_1_l; apply (f_equal (fun z => / IZR z)); reflexivity. Qed.
Lemma h32_is : Q2R h32Q = h32.
Proof. unfold Q2R, h32Q, h32, bpow; rewrite Rmult_1_l; apply (f_equal (fun z => / IZR z)); reflexivity. Qed.
Lemma u64_is : Q2R u64Q = u64.
Proof. unfold Q2R, u64Q, u64, bpow; rewrite Rmult_1_l; apply (f_equal (fun z => / IZR z)); reflexivity. Qed.

Definition computes32 := computes u32 rounds32 seen32.
Definition computes_normal := computes u32 rounds_normal seen64.
Definition computes64 := computes u64 rounds64 seen64.

(* Which inputs lose something as operands of a device that flushes denormals: all; or not those that are 0 or no
  denormals. *)
Definition keeps x (f : nat -> Q) := forall i, f i = h32Q \/ (f i = 0%Q /\ (x i = 0 \/ 2 * h32 <= Rabs (x i))).
Lemma all_may_lose x : keeps x (all h32Q).
Proof. intros i. now left. Qed.
Lemma keeps_range x f : keeps x f -> forall i, 0 <= Q2R (f i) <= h32.
Proof. intros K i. assert (0 < h32) by apply bpow_gt_0. destruct (K i) as [-> | [-> _]]; rewrite ?h32_is, ?Q2R_0';
  lra. Qed.
Lemma keeps_near x f : keeps x f -> forall i k v w, (k <= 16)%nat -> Rabs (v - x i) <= alpha u32 k * Rabs (x i) ->
  seen32 v w -> Rabs (w - v) <= Q2R (f i).
Proof.
  intros K i k v w Hk Hv S. destruct (K i) as [-> | [-> normal]]; [rewrite h32_is; now apply seen32_near |].
  rewrite Q2R_0'. assert (same : w = v); [| subst; rewrite Rminus_diag_eq, Rabs_R0 by reflexivity; lra].
  destruct S as [S | [small S]]; [exact S |]. subst w. destruct normal as [zero | normal].
  - rewrite zero, Rabs_R0, Rmult_0_r in Hv. apply between in Hv. lra.
  - exfalso. assert (A : alpha u32 k <= / 2).
    { unfold alpha. replace u32 with (/ 16777216) by (unfold u32; simpl; lra).
      do 17 (destruct k as [| k]; [simpl pow; lra |]). lia. }
    assert (G := Rmult_le_compat_r _ _ _ (Rabs_pos (x i)) A). assert (T := Rabs_triang_inv (x i) (x i - v)).
    replace (x i - (x i - v)) with v in T by ring. rewrite Rabs_minus_sym in Hv. lra.
Qed.

Section Devices.
Variable x : nat -> R.
Variable f m : nat -> Q.
Variable d : nat -> nat -> Q.
Let limited := within x (fun i => Q2R (m i)) (fun i j => Q2R (d i j)).
Hypothesis kept : keeps x f.

Theorem float_filter value size least constant v s t b :
  is_enough u32Q h32Q f m d value size least constant = true ->
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  computes32 x value v -> computes32 x size s -> Q2R least <= s -> seen32 s t -> rounds32 (Q2R constant * t) b ->
  b < Rabs v -> (0 < v <-> 0 < real x value) /\ real x value <> 0.
Proof.
  unfold computes32. rewrite <- u32_is. intros E. intros.
  eapply (sign_is_right u32Q h32Q f m d rounds32 seen32); try eassumption; rewrite ?u32_is, ?h32_is;
    auto using rounds32_near, seen32_near; try exact (keeps_range x f kept); try exact (keeps_near x f kept); unfold
      u32, h32; apply bpow_ge_0.
Qed.

Theorem float_error value size constant rest v s :
  is_within u32Q h32Q f m d value size constant rest = true ->
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  computes32 x value v -> computes32 x size s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s + Q2R rest.
Proof.
  unfold computes32. rewrite <- u32_is. intros E. intros.
  eapply (error_is_below u32Q h32Q f m d rounds32 seen32); try eassumption; rewrite ?u32_is, ?h32_is;
    auto using rounds32_near, seen32_near; try exact (keeps_range x f kept); try exact (keeps_near x f kept); unfold
      u32, h32; apply bpow_ge_0.
Qed.

End Devices.

Lemma nothing_lost u x e : lost u 0 x (fun _ => 0) e = 0.
Proof.
  assert (G : forall e, gap 0 (fun _ => 0) e = 0) by (intros []; simpl; try destruct (Nat.leb k 16); reflexivity).
  induction e; cbn [lost]; unfold of_product; rewrite ?IHe, ?IHe1, ?IHe2, ?IHe3, ?G; ring.
Qed.
Lemma nothing_flushed_range (i : nat) : 0 <= Q2R (all 0 i) <= 0.
Proof. unfold all. rewrite Q2R_0'. lra. Qed.
Lemma nothing_flushed_near (i : nat) v w : seen64 v w -> Rabs (w - v) <= Q2R (all 0 i).
Proof. unfold all. rewrite Q2R_0'. apply seen64_near. Qed.

Section Normal.
Variable x : nat -> R.
Variable m : nat -> Q.
Variable d : nat -> nat -> Q.
Let limited := within x (fun i => Q2R (m i)) (fun i j => Q2R (d i j)).

(* Where no operand and no result is below 2^-126, unless it is 0. *)
Theorem float_error_of_normal_numbers value size constant v s :
  is_within u32Q 0 (all 0) m d value size constant 0 = true ->
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  computes_normal x value v -> computes_normal x size s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s.
Proof.
  unfold computes_normal. rewrite <- u32_is. intros. assert (zero := Q2R_0').
  replace (Q2R constant * s) with (Q2R constant * s + Q2R 0) by (rewrite zero; ring).
  eapply (error_is_below u32Q 0 (all 0) m d rounds_normal seen64); try eassumption; rewrite ?u32_is, ?zero;
    auto using rounds_normal_near, seen64_near, nothing_flushed_range; try (intros; eapply nothing_flushed_near;
      eassumption); try lra; unfold u32; apply bpow_ge_0.
Qed.

(* The same without a size: the error of any expression. *)
Theorem error_of_normal_numbers e v :
  limited e -> computes_normal x e v -> Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e.
Proof.
  intros _ C. assert (N := computed_is_off u32 0 (bpow_ge_0 _ _) (Rle_refl 0) rounds_normal seen64 rounds_normal_near
    seen64_near x (fun _ => 0) (fun _ => conj (Rle_refl 0) (Rle_refl 0)) (fun _ _ v w _ _ => seen64_near v w) e v C).
  rewrite nothing_lost in N. lra.
Qed.

Theorem double_filter value size constant v s b :
  is_enough u64Q 0 (all 0) m d value size 0 constant = true ->
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  computes64 x value v -> computes64 x size s -> 0 <= s -> rounds64 (Q2R constant * s) b ->
  b < Rabs v -> (0 < v <-> 0 < real x value) /\ real x value <> 0.
Proof.
  unfold computes64. rewrite <- u64_is. intros. assert (zero := Q2R_0').
  eapply (sign_is_right u64Q 0 (all 0) m d rounds64 seen64) with (t := s) (least := 0%Q); try eassumption; rewrite
    ?u64_is, ?zero;
    auto using rounds64_near, seen64_near, nothing_flushed_range; try (intros; eapply nothing_flushed_near;
      eassumption); try lra; try reflexivity. unfold u64; apply bpow_ge_0.
Qed.
End Normal.

(* ---- Where nothing underflows
  -------------------------------------------------------------------------------------- *)

Definition any : Q := 2 ^ 129.
Definition computed x e v := computes_normal x e v /\ within_limits x (Q2R any) (Q2R any) e.
Lemma near x e v : computed x e v -> Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e.
Proof. intros [C L]. exact (error_of_normal_numbers x (fun _ => any) (fun _ _ => any) e v L C). Qed.
Lemma alpha_below k : (k <= 16)%nat -> alpha u32 k <= INR k * (1 + / 1048576) * / 16777216.
Proof.
  intros H. unfold alpha. replace u32 with (/ 16777216) by (unfold u32; simpl; lra).
  do 17 (destruct k as [| k]; [simpl pow; simpl INR; lra |]). lia.
Qed.
Lemma alpha_at_least k : 0 <= alpha u32 k.
Proof. apply alpha_positive. apply bpow_ge_0. Qed.

(* One operation at a time, where the sum of absolute products says too little. *)
Lemma one_rounding s v : rounds_normal s v -> Rabs (v - s) <= / 16777216 * Rabs s.
Proof. intros R. apply rounds_normal_near in R. replace u32 with (/ 16777216) in R by (unfold u32; simpl; lra). lra.
  Qed.
Lemma given_is x i v : computed x (Given i 0) v -> v = x i.
Proof.
  intros [C _]. inversion C as [ | ? ? ? H | | | | | | | | ]; subst. unfold alpha in H. simpl in H.
  replace (1 - 1) with 0 in H by ring. rewrite Rmult_0_l in H. apply between in H. lra.
Qed.
Ltac by_step C := destruct C as [C L]; unfold within_limits in L; cbn [within] in L; inversion C; subst;
  repeat match goal with H : seen64 _ _ |- _ => unfold seen64 in H; subst end.
Lemma step_diff x i j v : computed x (Diff i j) v -> Rabs (v - (x i - x j)) <= / 16777216 * Rabs (x i - x j).
Proof. intros C. by_step C. now apply one_rounding. Qed.
Lemma step_times x q a v : computed x (Times q a) v -> exists p, computed x a p /\
  Rabs (v - Q2R q * p) <= / 16777216 * Rabs (Q2R q * p).
Proof. intros C. by_step C. eexists; split; [split; eassumption | now apply one_rounding]. Qed.
Lemma step_add x a b v : computed x (Add a b) v -> exists p q, computed x a p /\ computed x b q /\
  Rabs (v - (p + q)) <= / 16777216 * Rabs (p + q).
Proof. intros C. by_step C. do 2 eexists. repeat split; try eassumption; try tauto. now apply one_rounding. Qed.
Lemma step_sub x a b v : computed x (Sub a b) v -> exists p q, computed x a p /\ computed x b q /\
  Rabs (v - (p - q)) <= / 16777216 * Rabs (p - q).
Proof. intros C. by_step C. do 2 eexists. repeat split; try eassumption; try tauto. now apply one_rounding. Qed.
Lemma step_mul x a b v : computed x (Mul a b) v -> exists p q, computed x a p /\ computed x b q /\
  Rabs (v - p * q) <= / 16777216 * Rabs (p * q).
Proof. intros C. by_step C. do 2 eexists. repeat split; try eassumption; try tauto. now apply one_rounding. Qed.
(* What is within b of 0 is off by at most u b. *)
Lemma at_most v s b : Rabs (v - s) <= / 16777216 * Rabs s -> Rabs s <= b -> Rabs (v - s) <= / 16777216 * b.
Proof. intros. eapply Rle_trans; [eassumption |]. apply Rmult_le_compat_l; lra. Qed.

(* ---- Where denormals are kept, or flushed, or both by turns
  ---------------------------------------------------------- *)

Definition lost32 x := lost u32 h32 x (fun _ => h32).
Lemma u32_value : u32 = / 16777216.
Proof. unfold u32; simpl; lra. Qed.
Lemma h32_positive : 0 < h32.
Proof. apply bpow_gt_0. Qed.
Lemma h32_below : h32 <= / 2 ^ 126.
Proof. unfold h32. simpl. lra. Qed.
Theorem near32 x e v : computes32 x e v -> Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e + lost32 x e.
Proof.
  intros C. refine (computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near seen32_near x
    (fun _ => h32) (fun _ => conj (bpow_ge_0 _ _) (Rle_refl h32)) _ e v C). intros; now apply seen32_near.
Qed.
Lemma lost32_positive x e : 0 <= lost32 x e.
Proof. apply lost_positive; intros; try split; try apply bpow_ge_0. apply Rle_refl. Qed.

(* What underflow takes, as a polynomial of one size L: input i is at most m i, the difference of i and j at most d i
  j, all
   of them polynomials of L (a number first, then the factors of L, L^2 and so on). `f`: see keeps. *)
Section Polynomials.
Open Scope Q_scope.
Definition polynomial := list Q.
Definition number (a : Q) : polynomial := (a :: nil)%list.
Definition line (a b : Q) : polynomial := (a :: b :: nil)%list.  (* a + b L *)
Fixpoint plusP (p q : polynomial) : polynomial :=
  match p, q with
  | nil, _ => q
  | _, nil => p
  | (a :: p)%list, (b :: q)%list => (Qred (a + b) :: plusP p q)%list
  end.
Definition scaledP (a : Q) (p : polynomial) : polynomial := List.map (fun b => Qred (a * b)) p.
Fixpoint timesP (p q : polynomial) : polynomial :=
  match p with nil => nil | (a :: p)%list => plusP (scaledP a q) (0 :: timesP p q)%list end.
Fixpoint not_above (p q : polynomial) : bool :=
  match p, q with
  | nil, _ => List.forallb (Qle_bool 0) q
  | (a :: p)%list, (b :: q)%list => Qle_bool a b && not_above p q
  | (a :: p)%list, nil => Qle_bool a 0 && not_above p nil
  end.
Variable f : nat -> Q.
Variable m : nat -> polynomial.
Variable d : nat -> nat -> polynomial.
Fixpoint largestP (e : expr) : polynomial :=
  match e with
  | Const q => Qabs q :: nil
  | Given i _ => m i
  | Diff i j => d i j
  | Times q a => scaledP (Qabs q) (largestP a)
  | Neg a | Abs a => largestP a
  | Add a b | Sub a b => plusP (largestP a) (largestP b)
  | Mul a b => timesP (largestP a) (largestP b)
  | Fma a b c => plusP (timesP (largestP a) (largestP b)) (largestP c)
  end.
Let one_more p := plusP (scaledP (1 + u32Q) p) (h32Q :: nil).
Definition of_productP a b A B p q :=
  plusP (plusP (scaledP (1 + alphaQ u32Q a) (timesP A q)) (scaledP (1 + alphaQ u32Q b) (timesP B p))) (timesP p q).
Definition operandP p e : polynomial := plusP p (gapQ h32Q f e :: nil).
Fixpoint underflowP (e : expr) : polynomial :=
  match e with
  | Const _ | Given _ _ => nil
  | Diff _ _ => one_more (2 * h32Q :: nil)
  | Times q a => one_more (scaledP (Qabs q) (operandP (underflowP a) a))
  | Neg a | Abs a => operandP (underflowP a) a
  | Add a b | Sub a b => one_more (plusP (operandP (underflowP a) a) (operandP (underflowP b) b))
  | Mul a b =>
      one_more (of_productP (roundings a) (roundings b) (largestP a) (largestP b) (operandP (underflowP a) a)
                            (operandP (underflowP b) b))
  | Fma a b c =>
      one_more (plusP (of_productP (roundings a) (roundings b) (largestP a) (largestP b) (operandP (underflowP a) a)
                                  (operandP (underflowP b) b)) (operandP (underflowP c) c))
  end.
End Polynomials.

Fixpoint at_size (L : R) (p : polynomial) : R := match p with nil => 0 | (a :: p)%list => Q2R a + L * at_size L p end.
Section AtSize.
Variable L : R.
Local Notation at_size := (at_size L).
Lemma plusP_is p : forall q, at_size (plusP p q) = at_size p + at_size q.
Proof. induction p; intros [| b q]; cbn [plusP at_size]; to_reals; rewrite ?IHp; ring. Qed.
Lemma scaledP_is a p : at_size (scaledP a p) = Q2R a * at_size p.
Proof. unfold scaledP. induction p; cbn [List.map at_size]; to_reals; rewrite ?IHp; ring. Qed.
Lemma timesP_is p q : at_size (timesP p q) = at_size p * at_size q.
Proof. induction p; cbn [timesP at_size]; [ring |]. rewrite plusP_is, scaledP_is. cbn [at_size]. to_reals. rewrite
  IHp. ring. Qed.
Lemma not_above_is p : forall q, 0 <= L -> not_above p q = true -> at_size p <= at_size q.
Proof.
  intros q L0. revert q.
  assert (none : forall q, List.forallb (Qle_bool 0) q = true -> 0 <= at_size q).
  { induction q as [| b q IH]; cbn; [lra |]. rewrite Bool.andb_true_iff. intros [B Hq]. apply Qle_bool_imp_le, Qle_Rle
    in B.
    rewrite Q2R_0' in B. assert (P := Rmult_le_pos _ _ L0 (IH Hq)). lra. }
  induction p as [| a p IH]; intros [| b q]; cbn [not_above at_size].
  - lra.
  - apply none.
  - rewrite Bool.andb_true_iff. intros [A Hp]. apply Qle_bool_imp_le, Qle_Rle in A. rewrite Q2R_0' in A.
    specialize (IH nil Hp). cbn in IH. assert (P := Rmult_le_compat_l _ _ _ L0 IH). lra.
  - rewrite Bool.andb_true_iff. intros [A Hp]. apply Qle_bool_imp_le, Qle_Rle in A.
    assert (P := Rmult_le_compat_l _ _ _ L0 (IH q Hp)). lra.
Qed.

Variable f : nat -> Q.
Variable m : nat -> polynomial.
Variable d : nat -> nat -> polynomial.
Let M i := at_size (m i).
Let D i j := at_size (d i j).
Lemma largestP_is e : at_size (largestP m d e) = largest M D e.
Proof.
  induction e; cbn [largestP largest at_size]; rewrite ?plusP_is, ?timesP_is, ?scaledP_is, ?Q2R_abs, ?IHe, ?IHe1,
    ?IHe2, ?IHe3;
    try reflexivity. ring.
Qed.
Lemma underflowP_is e : at_size (underflowP f m d e) = underflow u32 h32 (fun i => Q2R (f i)) M D e.
Proof.
  assert (G : forall e, Q2R (gapQ h32Q f e) = gap h32 (fun i => Q2R (f i)) e).
  { intros []; cbn [gapQ gap]; try destruct (Nat.leb k 16); try reflexivity; apply h32_is. }
  assert (W : forall p e, at_size (operandP f p e) = at_size p + gap h32 (fun i => Q2R (f i)) e).
  { intros p' e'. unfold operandP. rewrite plusP_is. cbn [at_size]. rewrite G. ring. }
  assert (O : forall a b A B p q, at_size (of_productP a b A B p q) =
    of_product (alpha u32 a) (alpha u32 b) (at_size A) (at_size B) (at_size p) (at_size q)).
  { intros. unfold of_productP, of_product. rewrite !plusP_is, !scaledP_is, !timesP_is. to_reals. rewrite !alpha_is,
    u32_is. ring. }
  induction e; cbn [underflowP underflow at_size];
    repeat (rewrite O || rewrite W || rewrite plusP_is || rewrite scaledP_is || rewrite largestP_is); cbn [at_size];
    to_reals; rewrite ?Q2R_abs, ?u32_is, ?h32_is, ?IHe, ?IHe1, ?IHe2, ?IHe3; ring.
Qed.
End AtSize.

Theorem lost_is_at_most x f m d L bound e : keeps x f -> 0 <= L ->
  within x (fun i => at_size L (m i)) (fun i j => at_size L (d i j)) e -> not_above (underflowP f m d e) bound = true ->
  lost u32 h32 x (fun i => Q2R (f i)) e <= at_size L bound.
Proof.
  intros K L0 W B. eapply Rle_trans; [| exact (not_above_is L _ _ L0 B)]. rewrite underflowP_is.
  apply lost_below; try apply bpow_ge_0; auto. exact (keeps_range x f K).
Qed.
Theorem lost32_is_at_most x m d L bound e : 0 <= L ->
  within x (fun i => at_size L (m i)) (fun i j => at_size L (d i j)) e -> not_above (underflowP (all h32Q) m d e)
    bound = true ->
  lost32 x e <= at_size L bound.
Proof.
  intros L0 W B. assert (G := lost_is_at_most x (all h32Q) m d L bound e (all_may_lose x) L0 W B). unfold all in G.
  unfold lost32. replace (fun _ : nat => h32) with (fun _ : nat => Q2R h32Q); [exact G |].
  now rewrite h32_is.
Qed.

(* Closes what near_at_size asks of the inputs, by hypotheses of the form |x| <= a or |x| <= a L. *)
Ltac within_sizes :=
  cbn -[Q2R Rabs]; repeat split; rewrite ?Q2R_0', ?Q2R_1; repeat match goal with |- context [Q2R (?a # ?b)] =>
    replace (Q2R (a # b)) with (IZR a / IZR (Zpos b)) by reflexivity end; try lra.
Definition tiny : Q := 1 # 1298074214633706907132624082305024.  (* 2^-110 *)
Lemma tiny_is : Q2R tiny = / 1298074214633706907132624082305024.
Proof. unfold Q2R, tiny; simpl; lra. Qed.
Theorem near_at_size x m d L bound e v : 0 <= L -> not_above (underflowP (all h32Q) m d e) bound = true ->
  within x (fun i => at_size L (m i)) (fun i j => at_size L (d i j)) e -> computes32 x e v ->
  Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e + at_size L bound.
Proof. intros L0 B W C. assert (N := near32 x e v C). assert (U := lost32_is_at_most x m d L bound e L0 W B). lra. Qed.

Theorem near_at_size_keeping x f m d L bound e v : keeps x f -> 0 <= L -> not_above (underflowP f m d e) bound = true ->
  within x (fun i => at_size L (m i)) (fun i j => at_size L (d i j)) e -> computes32 x e v ->
  Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e + at_size L bound.
Proof.
  intros K L0 B W C. assert (U := lost_is_at_most x f m d L bound e K L0 W B).
  assert (N := computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near seen32_near x
    (fun i => Q2R (f i)) (keeps_range x f K) (keeps_near x f K) e v C). lra.
Qed.

(* The same by one number, where no input and no difference exceeds a limit. *)
Definition limited32 (limit : Q) x e v := computes32 x e v /\ within_limits x (Q2R limit) (Q2R limit) e.
Definition takes (limit : Q) e := underflowQ u32Q h32Q (all h32Q) (all limit) (apart limit) e.
Theorem near_limited limit rest x e v : Qle_bool (takes limit e) rest = true -> limited32 limit x e v ->
  Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e + Q2R rest.
Proof.
  intros E [C W]. apply Qle_bool_imp_le, Qle_Rle in E. unfold takes in E. rewrite underflow_is, u32_is, h32_is in E.
  assert (N := near32 x e v C). assert (0 <= h32) by apply bpow_ge_0.
  assert (L : lost32 x e <= underflow u32 h32 (fun _ => h32) (fun _ => Q2R limit) (fun _ _ => Q2R limit) e).
  { apply lost_below; auto; try apply bpow_ge_0. intros; lra. }
  replace (fun i : nat => Q2R (all h32Q i)) with (fun _ : nat => h32) in E by (unfold all; now rewrite h32_is).
  unfold all, apart in E. lra.
Qed.

Tactic Notation "near_in" constr(limit) constr(rest) constr(e) hyp(C) :=
  apply (near_limited limit rest _ e _ ltac:(vm_compute; reflexivity)) in C.

(* What a bound in proportion to a computed size leaves: what underflow takes of the value, and the constant times what it
   takes of the size. taken_within() has both by limits of the inputs. *)
Definition taken x f e := lost u32 h32 x (fun i => Q2R (f i)) e.
Theorem error_but_taken x f value size constant v s : keeps x f ->
  Qle_bool (rate u32Q value size) constant = true -> Qle_bool 1 (alphaQ u32Q (roundings size)) = false ->
  permanent x value <= permanent x size -> real x size = permanent x size ->
  computes32 x value v -> computes32 x size s ->
  Rabs (v - real x value) <= Q2R constant * s + (taken x f value + Q2R constant * taken x f size).
Proof.
  intros K E E1 Hp Hs Cv Cs. apply Qle_bool_imp_le, Qle_Rle in E.
  assert (off := computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near seen32_near x
    (fun i => Q2R (f i)) (keeps_range x f K) (keeps_near x f K)).
  assert (Nv := off _ _ Cv). assert (Ns := off _ _ Cs). clear off. fold (taken x f value) in Nv. fold (taken x f size) in Ns.
  assert (L : 0 <= taken x f size) by (apply lost_positive; try apply bpow_ge_0; exact (keeps_range x f K)).
  assert (E2 : (alphaQ u32Q (roundings size) < 1)%Q).
  { apply Qnot_le_lt. intro H. apply Qle_bool_iff in H. congruence. }
  assert (nonzero : ~ (1 - alphaQ u32Q (roundings size) == 0)%Q).
  { intro H. assert (H' : (alphaQ u32Q (roundings size) == 1)%Q) by (rewrite <- Qplus_0_r, <- H; ring).
    rewrite H' in E2. now apply Qlt_irrefl in E2. }
  apply Qlt_Rlt in E2. rewrite alpha_is, Q2R_1, u32_is in E2.
  unfold rate in E. rewrite Q2R_red, Q2R_div, Q2R_minus, Q2R_1, !alpha_is, u32_is in E by exact nonzero.
  assert (A := alpha_at_least (roundings value)). set (a := alpha u32 (roundings value)) in *.
  set (g := alpha u32 (roundings size)) in *. rewrite Hs in Ns. apply between in Ns. set (P := permanent x size) in *.
  assert (P0 : 0 <= P) by apply permanent_positive. assert (s0 : (1 - g) * P <= s + taken x f size) by lra.
  assert (A1 : 0 <= a / (1 - g)) by (unfold Rdiv; apply Rmult_le_pos; [exact A | left; apply Rinv_0_lt_compat; lra]).
  assert (AP := Rmult_le_compat_l _ _ _ A1 s0). replace (a / (1 - g) * ((1 - g) * P)) with (a * P) in AP by (field; lra).
  assert (G : 0 <= (1 - g) * P) by (apply Rmult_le_pos; lra).
  assert (c := Rmult_le_compat_r (s + taken x f size) _ _ ltac:(lra) E).
  assert (aP := Rmult_le_compat_l a _ _ A Hp). lra.
Qed.
Theorem taken_within x f m d e : keeps x f -> within x m d e ->
  taken x f e <= underflow u32 h32 (fun i => Q2R (f i)) m d e.
Proof. intros K W. apply lost_below; try apply bpow_ge_0; auto. exact (keeps_range x f K). Qed.
Theorem taken_of_limits x f m d e rest : keeps x f -> Qle_bool (underflowQ u32Q h32Q f m d e) rest = true ->
  within x (fun i => Q2R (m i)) (fun i j => Q2R (d i j)) e -> taken x f e <= Q2R rest.
Proof.
  intros K E W. apply Qle_bool_imp_le, Qle_Rle in E. rewrite underflow_is, u32_is, h32_is in E.
  assert (T := taken_within x f _ _ e K W). lra.
Qed.
Lemma h32_powers : 0 < h32 <= / 2 ^ 126 /\ 0 <= h32 * h32 <= / 2 ^ 126 * h32.
Proof.
  assert (h := h32_positive). assert (h1 := h32_below).
  repeat split; try lra; [apply Rmult_le_pos | apply Rmult_le_compat_r]; lra.
Qed.
(* Of an `underflow`: a polynomial with numbers. *)
Ltac underflow_in_numbers := cbn -[u32 h32 Q2R taken]; unfold of_product, alpha; rewrite ?u32_value, ?Q2R_0', ?h32_is; simpl pow.

(* One operation at a time: what it takes of its operands and its result is below a few h. *)
Lemma one_rounding32 s v : rounds32 s v -> Rabs (v - s) <= / 16777216 * Rabs s + h32.
Proof. intros R. apply rounds32_near in R. rewrite u32_value in R. exact R. Qed.
Lemma given32_is x i v : computes32 x (Given i 0) v -> v = x i.
Proof.
  intros C. inversion C as [ | ? ? ? H | | | | | | | | ]; subst. unfold alpha in H. simpl in H.
  replace (1 - 1) with 0 in H by ring. rewrite Rmult_0_l in H. apply between in H. lra.
Qed.
Lemma const32_is x q v : computes32 x (Const q) v -> v = Q2R q.
Proof. intros C. now inversion C. Qed.
Lemma after_sum32 p q s t v : seen32 p s -> seen32 q t -> rounds32 (s + t) v ->
  Rabs (v - (p + q)) <= / 16777216 * Rabs (p + q) + 4 * h32.
Proof.
  intros P Q R. apply seen32_near in P, Q. apply one_rounding32 in R. assert (h := h32_positive).
  assert (T : Rabs (s + t - (p + q)) <= 2 * h32).
  { replace (s + t - (p + q)) with ((s - p) + (t - q)) by ring. eapply Rle_trans; [apply Rabs_triang | lra]. }
  assert (T1 := Rabs_triang (s + t - (p + q)) (p + q)). replace (s + t - (p + q) + (p + q)) with (s + t) in T1 by ring.
  replace (v - (p + q)) with ((v - (s + t)) + (s + t - (p + q))) by ring. eapply Rle_trans; [apply Rabs_triang | lra].
Qed.
Lemma after_difference32 p q s t v : seen32 p s -> seen32 q t -> rounds32 (s - t) v ->
  Rabs (v - (p - q)) <= / 16777216 * Rabs (p - q) + 4 * h32.
Proof.
  intros P Q R. apply (after_sum32 p (- q) s (- t)); auto.
  destruct Q as [-> | [Q ->]]; [left; ring | right; rewrite Rabs_Ropp; split; [exact Q | ring]].
Qed.
Lemma after_product32 p q s t v : seen32 p s -> seen32 q t -> rounds32 (s * t) v ->
  Rabs (v - p * q) <= / 16777216 * Rabs (p * q) + 2 * h32 * (Rabs p + Rabs q + 1).
Proof.
  intros P Q R. apply seen32_near in P, Q. apply one_rounding32 in R. assert (h := h32_positive).
  assert (h1 : h32 <= / 100) by (assert (H := h32_below); simpl in H; lra).
  assert (T : Rabs (s * t - p * q) <= h32 * (Rabs p + Rabs q + / 100)).
  { replace (s * t - p * q) with ((s - p) * q + ((t - q) * p + (s - p) * (t - q))) by ring.
    assert (A := Rmult_le_compat_r _ _ _ (Rabs_pos q) P). assert (B := Rmult_le_compat_r _ _ _ (Rabs_pos p) Q).
    assert (C := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) P Q). rewrite <- !Rabs_mult in A, B, C.
    assert (D := Rmult_le_compat_l h32 _ _ ltac:(lra) h1).
    eapply Rle_trans; [apply Rabs_triang |]. assert (E := Rabs_triang ((t - q) * p) ((s - p) * (t - q))). lra. }
  assert (T1 := Rabs_triang (s * t - p * q) (p * q)). replace (s * t - p * q + p * q) with (s * t) in T1 by ring.
  assert (S : 0 <= h32 * (Rabs p + Rabs q)).
  { apply Rmult_le_pos; [lra |]. apply Rplus_le_le_0_compat; apply Rabs_pos. }
  replace (v - p * q) with ((v - s * t) + (s * t - p * q)) by ring. eapply Rle_trans; [apply Rabs_triang | lra].
Qed.
Lemma step32_diff x i j v : computes32 x (Diff i j) v ->
  Rabs (v - (x i - x j)) <= / 16777216 * Rabs (x i - x j) + 4 * h32.
Proof. intros C. inversion C; subst. eapply after_difference32; eassumption. Qed.
Lemma step32_add x a b v : computes32 x (Add a b) v -> exists p q, computes32 x a p /\ computes32 x b q /\
  Rabs (v - (p + q)) <= / 16777216 * Rabs (p + q) + 4 * h32.
Proof. intros C. inversion C; subst. do 2 eexists. repeat split; try eassumption. eapply after_sum32; eassumption. Qed.
Lemma step32_sub x a b v : computes32 x (Sub a b) v -> exists p q, computes32 x a p /\ computes32 x b q /\
  Rabs (v - (p - q)) <= / 16777216 * Rabs (p - q) + 4 * h32.
Proof. intros C. inversion C; subst. do 2 eexists. repeat split; try eassumption. eapply after_difference32;
  eassumption. Qed.
Lemma step32_mul x a b v : computes32 x (Mul a b) v -> exists p q, computes32 x a p /\ computes32 x b q /\
  Rabs (v - p * q) <= / 16777216 * Rabs (p * q) + 2 * h32 * (Rabs p + Rabs q + 1).
Proof. intros C. inversion C; subst. do 2 eexists. repeat split; try eassumption. eapply after_product32; eassumption.
  Qed.
Lemma step32_fma x a b c v : computes32 x (Fma a b c) v -> exists p q r, computes32 x a p /\ computes32 x b q /\
  computes32 x c r /\ Rabs (v - (p * q + r)) <= / 16777216 * Rabs (p * q + r) + 2 * h32 * (Rabs p + Rabs q + 2).
Proof.
  intros C. inversion C as [ | | | | | | | | | ? ? ? p q r s t w ? Cp Cq Cr P Q W R ]; subst. exists p, q, r.
  repeat split; auto. apply seen32_near in P, Q, W. apply one_rounding32 in R. assert (h := h32_positive).
  assert (h1 : h32 <= / 100) by (assert (H := h32_below); simpl in H; lra).
  assert (T : Rabs (s * t + w - (p * q + r)) <= h32 * (Rabs p + Rabs q + 101 / 100)).
  { replace (s * t + w - (p * q + r)) with ((s - p) * q + (((t - q) * p + (s - p) * (t - q)) + (w - r))) by ring.
    assert (A := Rmult_le_compat_r _ _ _ (Rabs_pos q) P). assert (B := Rmult_le_compat_r _ _ _ (Rabs_pos p) Q).
    assert (D := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) P Q). rewrite <- !Rabs_mult in A, B, D.
    assert (E := Rmult_le_compat_l h32 _ _ ltac:(lra) h1).
    eapply Rle_trans; [apply Rabs_triang |]. assert (F := Rabs_triang ((t - q) * p + (s - p) * (t - q)) (w - r)).
    assert (G := Rabs_triang ((t - q) * p) ((s - p) * (t - q))). lra. }
  assert (T1 := Rabs_triang (s * t + w - (p * q + r)) (p * q + r)).
  replace (s * t + w - (p * q + r) + (p * q + r)) with (s * t + w) in T1 by ring.
  assert (S : 0 <= h32 * (Rabs p + Rabs q)).
  { apply Rmult_le_pos; [lra |]. apply Rplus_le_le_0_compat; apply Rabs_pos. }
  replace (v - (p * q + r)) with ((v - (s * t + w)) + (s * t + w - (p * q + r))) by ring.
  eapply Rle_trans; [apply Rabs_triang | lra].
Qed.
Lemma step32_neg x a v : computes32 x (Neg a) v -> exists p, computes32 x a p /\ Rabs (v + p) <= h32.
Proof.
  intros C. inversion C; subst. eexists; split; [eassumption |].
  match goal with H : seen32 _ _ |- _ => apply seen32_near in H end. rewrite Rabs_minus_sym in *.
  match goal with |- Rabs ?y <= _ => replace y with (p - s) by ring end. assumption.
Qed.
Lemma step32_times x q a v : computes32 x (Times q a) v -> exists p, computes32 x a p /\
  Rabs (v - Q2R q * p) <= / 16777216 * Rabs (Q2R q * p) + 2 * h32 * (Rabs (Q2R q) + 1).
Proof.
  intros C. inversion C as [ | | | ? ? p s ? Hp Hs R | | | | | | ]; subst. exists p. split; [exact Hp |].
  apply seen32_near in Hs. apply one_rounding32 in R. assert (h := h32_positive).
  assert (T : Rabs (Q2R q * s - Q2R q * p) <= Rabs (Q2R q) * h32).
  { rewrite <- Rmult_minus_distr_l, Rabs_mult. apply Rmult_le_compat_l; auto using Rabs_pos. }
  assert (T1 := Rabs_triang (Q2R q * s - Q2R q * p) (Q2R q * p)).
  replace (Q2R q * s - Q2R q * p + Q2R q * p) with (Q2R q * s) in T1 by ring.
  assert (S : 0 <= Rabs (Q2R q) * h32) by (apply Rmult_le_pos; [apply Rabs_pos | lra]).
  replace (v - Q2R q * p) with ((v - Q2R q * s) + (Q2R q * s - Q2R q * p)) by ring.
  eapply Rle_trans; [apply Rabs_triang | lra].
Qed.
(* Rounding and flushing keep signs. *)
Local Instance float_format : Valid_exp (FLT_exp (-149) 24).
Proof. apply FLT_exp_valid. unfold Prec_gt_0. lia. Qed.
Lemma rounds32_positive s v : rounds32 s v -> (0 < v -> 0 < s) /\ (0 <= s -> 0 <= v).
Proof.
  assert (Z : forall c, 0 = round radix2 (FLT_exp (-149) 24) (Znearest c) 0) by (intros; now rewrite round_0 by apply
    valid_rnd_N).
  intros [[c ->] | [_ ->]]; [| split; [lra | intros; lra]]. unfold rounded32. split; intros H.
  - destruct (Rlt_or_le 0 s) as [P | P]; [exact P |]. exfalso.
    assert (L := round_le radix2 (FLT_exp (-149) 24) (Znearest c) s 0 P). rewrite <- Z in L. lra.
  - rewrite (Z c). apply round_le; [apply float_format | apply valid_rnd_N | exact H].
Qed.
Lemma seen32_positive v w : seen32 v w -> (0 < w -> 0 < v) /\ (0 <= v -> 0 <= w).
Proof. intros [-> | [_ ->]]; split; intros; lra. Qed.
Fixpoint positive x e : Prop :=
  match e with
  | Const q => 0 <= Q2R q
  | Given i k => k = O /\ 0 <= x i
  | Abs _ => True
  | Times q a => 0 <= Q2R q /\ positive x a
  | Add a b | Mul a b => positive x a /\ positive x b
  | _ => False
  end.
Lemma positive_is x e v : positive x e -> computes32 x e v -> 0 <= v.
Proof.
  intros P C. revert P. induction C; cbn [positive]; try tauto; intros P;
    try match goal with H : rounds32 _ _ |- _ => apply (proj2 (rounds32_positive _ _ H)) end.
  - destruct P as [-> P]. replace v with (x i); [exact P |]. symmetry. apply (given32_is x i). now constructor.
  - apply Rmult_le_pos; [tauto |]. apply (proj2 (seen32_positive _ _ H)); tauto.
  - apply Rabs_pos.
  - apply Rplus_le_le_0_compat; [apply (proj2 (seen32_positive _ _ H)) | apply (proj2 (seen32_positive _ _ H0))]; tauto.
  - apply Rmult_le_pos; [apply (proj2 (seen32_positive _ _ H)) | apply (proj2 (seen32_positive _ _ H0))]; tauto.
Qed.

(* What is within b of 0 is off by at most u b, and what it was. *)
Lemma at_most32 v s b l : Rabs (v - s) <= / 16777216 * Rabs s + l -> Rabs s <= b -> Rabs (v - s) <= / 16777216 * b + l.
Proof. intros. assert (/ 16777216 * Rabs s <= / 16777216 * b) by (apply Rmult_le_compat_l; lra). lra. Qed.

(* What has only positive terms is computed at least as this, from what its operands are at least. *)
Lemma seen32_least p s A : seen32 p s -> 0 <= A <= p -> 0 <= s /\ A - h32 <= s.
Proof. assert (h := h32_positive). intros [-> | [small ->]] ?; [split; lra |]. rewrite Rabs_pos_eq in small by lra. split; lra. Qed.
Lemma rounds32_least s v : rounds32 s v -> 0 <= s -> (1 - / 16777216) * s - h32 <= v.
Proof. intros R s0. apply one_rounding32 in R. rewrite (Rabs_pos_eq s s0) in R. apply between in R. lra. Qed.
Lemma least_given x i v : computes32 x (Given i 0) v -> x i <= v.
Proof. intros C. apply given32_is in C. lra. Qed.
Lemma least_const x q v : computes32 x (Const q) v -> Q2R q <= v.
Proof. intros C. apply const32_is in C. lra. Qed.
Lemma least_abs x a A v : computes32 x (Abs a) v -> (forall p, computes32 x a p -> A <= Rabs p) -> A - h32 <= v.
Proof.
  intros C H. inversion C as [ | | | | | ? p s Cp S | | | | ]; subst. apply H in Cp. apply seen32_near in S.
  assert (T := Rabs_triang_inv p (p - s)). replace (p - (p - s)) with s in T by ring. rewrite Rabs_minus_sym in S. lra.
Qed.
Lemma least_abs_given x i v : computes32 x (Abs (Given i 0)) v -> Rabs (x i) - h32 <= v.
Proof. intros C. apply (least_abs _ _ _ _ C). intros p Cp. apply given32_is in Cp. subst. lra. Qed.
Lemma least_abs_diff x i j v : computes32 x (Abs (Diff i j)) v ->
  (1 - / 16777216) * Rabs (x i - x j) - 5 * h32 <= v.
Proof.
  intros C. replace ((1 - / 16777216) * Rabs (x i - x j) - 5 * h32) with
    ((1 - / 16777216) * Rabs (x i - x j) - 4 * h32 - h32) by ring.
  apply (least_abs _ _ _ _ C). intros p Cp. apply step32_diff in Cp.
  assert (T := Rabs_triang_inv (x i - x j) (x i - x j - p)). rewrite (Rabs_minus_sym p) in Cp.
  replace (x i - x j - (x i - x j - p)) with p in T by ring. lra.
Qed.
Lemma least_add x a b A B v : computes32 x (Add a b) v -> 0 <= A -> 0 <= B ->
  (forall p, computes32 x a p -> A <= p) -> (forall q, computes32 x b q -> B <= q) ->
  (1 - / 16777216) * (A + B) - 4 * h32 <= v.
Proof.
  intros C A0 B0 HA HB. inversion C as [ | | | | | | ? ? p q s t ? Cp Cq S T R | | | ]; subst. apply HA in Cp. apply HB in Cq.
  destruct (seen32_least _ _ _ S (conj A0 Cp)). destruct (seen32_least _ _ _ T (conj B0 Cq)).
  apply rounds32_least in R; [| lra]. assert (h := h32_positive).
  assert (G := Rmult_le_compat_l (1 - / 16777216) (A + B - 2 * h32) (s + t) ltac:(lra) ltac:(lra)). lra.
Qed.
Lemma least_mul x a b A B v : computes32 x (Mul a b) v -> 0 <= A -> 0 <= B ->
  (forall p, computes32 x a p -> A <= p) -> (forall q, computes32 x b q -> B <= q) ->
  (1 - / 16777216) * (A * B) - h32 * (A + B + 1) <= v.
Proof.
  intros C A0 B0 HA HB. inversion C as [ | | | | | | | | ? ? p q s t ? Cp Cq S T R | ]; subst. apply HA in Cp. apply HB in Cq.
  destruct (seen32_least _ _ _ S (conj A0 Cp)) as [s0 s1]. destruct (seen32_least _ _ _ T (conj B0 Cq)) as [t0 t1].
  apply rounds32_least in R; [| now apply Rmult_le_pos]. assert (h := h32_positive).
  assert (AB : A * B - h32 * (A + B) <= s * t).
  { destruct (Rle_dec h32 A) as [a1 | a1].
    - destruct (Rle_dec h32 B) as [c1 | c1].
      + assert (G := Rmult_le_compat (A - h32) s (B - h32) t ltac:(lra) ltac:(lra) s1 t1).
        assert (0 <= h32 * h32) by (apply Rmult_le_pos; lra). lra.
      + assert (G := Rmult_le_compat_l A B h32 A0 ltac:(lra)). assert (0 <= h32 * B) by (apply Rmult_le_pos; lra).
        assert (0 <= s * t) by (now apply Rmult_le_pos). lra.
    - assert (G := Rmult_le_compat_r B A h32 B0 ltac:(lra)). assert (0 <= h32 * A) by (apply Rmult_le_pos; lra).
      assert (0 <= s * t) by (now apply Rmult_le_pos). lra. }
  assert (G := Rmult_le_compat_l (1 - / 16777216) _ _ ltac:(lra) AB).
  assert (0 <= h32 * (A + B)) by (apply Rmult_le_pos; lra). lra.
Qed.
Lemma least_times x q a A v : computes32 x (Times q a) v -> 0 <= Q2R q -> 0 <= A -> (forall p, computes32 x a p -> A <= p) ->
  (1 - / 16777216) * (Q2R q * A) - h32 * (Q2R q + 1) <= v.
Proof.
  intros C q0 A0 HA. inversion C as [ | | | ? ? p s ? Cp S R | | | | | | ]; subst. apply HA in Cp.
  destruct (seen32_least _ _ _ S (conj A0 Cp)) as [s0 s1]. assert (h := h32_positive).
  apply rounds32_least in R; [| now apply Rmult_le_pos]. assert (G := Rmult_le_compat_l _ _ _ q0 s1).
  assert (G2 := Rmult_le_compat_l (1 - / 16777216) _ _ ltac:(lra) G).
  assert (0 <= Q2R q * h32) by (apply Rmult_le_pos; lra). lra.
Qed.

(* An expression without differences but those of inputs, and without anything negative, is computed at least as this; what
   underflow takes of it comes from what it takes of its operands (`l`: that and their own flushing). *)
Lemma alpha_32 k : (k <= 32)%nat -> 0 <= alpha u32 k <= / 500000.
Proof.
  intros K. split; [apply alpha_at_least |]. eapply Rle_trans; [apply (alpha_grows u32 (bpow_ge_0 _ _) _ (16 + 16)); lia |].
  assert (E := alpha_sum u32 16 16). set (k32 := alpha u32 (16 + 16)) in *. assert (A := alpha_below 16 ltac:(lia)). simpl INR in A. assert (A0 := alpha_at_least 16).
  assert (S := Rmult_le_compat _ _ _ _ A0 A0 A A). clearbody k32. lra.
Qed.
Definition loses x e l := lost32 x e + h32 <= l.
Lemma gap32 x e : loses x e (lost32 x e + h32) /\ gap h32 (fun _ => h32) e = h32.
Proof. split; [apply Rle_refl |]. destruct e; simpl; try destruct (Nat.leb k 16); reflexivity. Qed.
Ltac of_operands := unfold loses, lost32; cbn [lost]; rewrite ?(proj2 (gap32 (fun _ => 0) _)); assert (h := h32_positive);
  replace (1 + u32) with (1 + / 16777216) by (now rewrite u32_value); intros.
Lemma loses_const x q l : h32 <= l -> loses x (Const q) l.
Proof. unfold loses, lost32. cbn [lost]. lra. Qed.
Lemma loses_given x i k l : h32 <= l -> loses x (Given i k) l.
Proof. unfold loses, lost32. cbn [lost]. lra. Qed.
Lemma loses_diff x i j l : 5 * h32 <= l -> loses x (Diff i j) l.
Proof. of_operands. lra. Qed.
Lemma loses_abs x a la l : loses x a la -> la + h32 <= l -> loses x (Abs a) l.
Proof. of_operands. lra. Qed.
Lemma loses_add x a b la lb l : loses x a la -> loses x b lb -> 101 / 100 * (la + lb) + 2 * h32 <= l -> loses x (Add a b) l.
Proof.
  of_operands. assert (A := lost32_positive x a). assert (B := lost32_positive x b). unfold lost32 in *. lra.
Qed.
Lemma loses_times x q a la l : loses x a la -> 101 / 100 * (Rabs (Q2R q) * la) + 2 * h32 <= l -> loses x (Times q a) l.
Proof.
  of_operands. intros. assert (A := lost32_positive x a). unfold lost32 in A.
  assert (G := Rmult_le_compat_l _ _ _ (Rabs_pos (Q2R q)) H). assert (P := Rmult_le_pos _ la (Rabs_pos (Q2R q)) ltac:(lra)). lra.
Qed.
Lemma loses_mul x a b P Q la lb l : (roundings a <= 32)%nat -> (roundings b <= 32)%nat -> permanent x a <= P -> permanent x b <= Q ->
  loses x a la -> loses x b lb -> 101 / 100 * (P * lb + Q * la + la * lb) + 2 * h32 <= l -> loses x (Mul a b) l.
Proof.
  intros Ka Kb HP HQ. of_operands. intros. assert (A := lost32_positive x a). assert (B := lost32_positive x b).
  assert (Pa := permanent_positive x a). assert (Pb := permanent_positive x b). unfold lost32 in A, B.
  apply alpha_32 in Ka, Kb. set (k := alpha u32 (roundings a)) in *. set (k' := alpha u32 (roundings b)) in *.
  assert (O := of_product_grows k k' _ _ _ _ P Q la lb ltac:(lra) ltac:(lra) (conj Pa HP) (conj Pb HQ)
    (conj (Rplus_le_le_0_compat _ _ A (Rlt_le _ _ h)) H) (conj (Rplus_le_le_0_compat _ _ B (Rlt_le _ _ h)) H0)).
  unfold of_product in *.
  assert (p1 := Rmult_le_pos P lb ltac:(lra) ltac:(lra)). assert (p2 := Rmult_le_pos Q la ltac:(lra) ltac:(lra)).
  assert (p3 := Rmult_le_pos la lb ltac:(lra) ltac:(lra)). assert (k1 := Rmult_le_compat_r _ _ _ p1 (proj2 Ka)).
  assert (k2 := Rmult_le_compat_r _ _ _ p2 (proj2 Kb)). lra.
Qed.
Fixpoint one_product e : Prop := match e with Given _ _ | Diff _ _ => True | Mul a b => one_product a /\ one_product b | _ => False end.
Lemma one_product_is x e : one_product e -> permanent x e = Rabs (real x e).
Proof.
  induction e; cbn [one_product permanent real]; try tauto; auto. intros [A B]. rewrite Rabs_mult, IHe1, IHe2; auto.
Qed.
Fixpoint only_positive x e : Prop :=
  match e with
  | Const q => 0 <= Q2R q
  | Given i _ => 0 <= x i
  | Abs a => one_product a
  | Times q a => 0 <= Q2R q /\ only_positive x a
  | Add a b | Mul a b => only_positive x a /\ only_positive x b
  | _ => False
  end.
Lemma permanent_is x e : only_positive x e -> permanent x e = real x e /\ 0 <= real x e.
Proof.
  induction e; cbn [only_positive permanent real]; try tauto.
  - intros. split; [now apply Rabs_pos_eq | assumption].
  - intros. split; [now apply Rabs_pos_eq | assumption].
  - intros [Q P]. destruct (IHe P) as [-> G]. rewrite (Rabs_pos_eq _ Q). split; [reflexivity | now apply Rmult_le_pos].
  - intros P. split; [now apply one_product_is | apply Rabs_pos].
  - intros [P Q]. destruct (IHe1 P) as [-> A]. destruct (IHe2 Q) as [-> B]. split; [reflexivity | lra].
  - intros [P Q]. destruct (IHe1 P) as [-> A]. destruct (IHe2 Q) as [-> B]. split; [reflexivity | now apply Rmult_le_pos].
Qed.
Theorem least_positive x e l v : only_positive x e -> (roundings e <= 32)%nat -> loses x e l -> computes32 x e v ->
  (1 - / 500000) * real x e - l <= v.
Proof.
  intros P K L C. apply permanent_is in P. destruct P as [P R0]. apply near32 in C. rewrite P in C. apply alpha_32 in K.
  assert (h := h32_positive). assert (G := Rmult_le_compat_r _ _ _ R0 (proj2 K)). unfold loses in L. apply between in C. lra.
Qed.

(* The same in double. *)
Definition any64 : Q := 2 ^ 1025.
Definition computed64 x e v := computes64 x e v /\ within_limits x (Q2R any64) (Q2R any64) e.
Lemma near64 x e v : computed64 x e v -> Rabs (v - real x e) <= alpha u64 (roundings e) * permanent x e.
Proof.
  intros [C _]. assert (N := computed_is_off u64 0 (bpow_ge_0 _ _) (Rle_refl 0) rounds64 seen64 rounds64_near
    seen64_near x (fun _ => 0) (fun _ => conj (Rle_refl 0) (Rle_refl 0)) (fun _ _ v w _ _ => seen64_near v w) e v C).
  rewrite nothing_lost in N. lra.
Qed.
Lemma alpha64_below k : (k <= 16)%nat -> alpha u64 k <= INR k * (1 + / 1048576) * / 9007199254740992.
Proof.
  intros H. unfold alpha. replace u64 with (/ 9007199254740992) by (unfold u64; simpl; lra).
  do 17 (destruct k as [| k]; [simpl pow; simpl INR; lra |]). lia.
Qed.
Lemma alpha64_at_least k : 0 <= alpha u64 k.
Proof. apply alpha_positive. apply bpow_ge_0. Qed.

(* In double with what underflow takes, denormals kept or flushed. *)
Definition computes64_any := computes u64 rounds64_any seen64_any.
Definition lost64 x := lost u64 h64 x (fun _ => h64).
Lemma u64_value : u64 = / 9007199254740992.
Proof. unfold u64; simpl; lra. Qed.
Lemma h64_positive : 0 < h64.
Proof. apply bpow_gt_0. Qed.
Lemma h64_below : h64 <= / 1606938044258990275541962092341162602522202993782792835301376.  (* 2^-200 *)
Proof.
  unfold h64. eapply Rle_trans; [apply (bpow_le radix2 (-1022) (-200)); lia |]. simpl. lra.
Qed.
Theorem near64_any x e v : computes64_any x e v ->
  Rabs (v - real x e) <= alpha u64 (roundings e) * permanent x e + lost64 x e.
Proof.
  intros C. refine (computed_is_off u64 h64 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds64_any seen64_any rounds64_any_near
    seen64_any_near x (fun _ => h64) (fun _ => conj (bpow_ge_0 _ _) (Rle_refl h64)) _ e v C).
  intros; now apply seen64_any_near.
Qed.
Lemma alpha64_is_below k : (k <= 16)%nat -> alpha (/ 9007199254740992) k <= INR k * (1 + / 1048576) * / 9007199254740992.
Proof. intros H. rewrite <- u64_value at 1. now apply alpha64_below. Qed.

(* Closes `permanent x value <= permanent x size`, where both are equal, and `real x size = permanent x size`. *)
Ltac same_products :=
  intros; cbn; repeat (rewrite Rabs_mult || rewrite Rabs_Rabsolu || rewrite (Rabs_pos_eq (Rabs _ * _ + _)));
  auto using Rabs_pos; try apply Req_le; ring.

(* The sizes in a goal are not negative. *)
Ltac sizes_are_positive :=
  repeat match goal with |- context [Rabs ?y] => lazymatch goal with
    | H : 0 <= Rabs y |- _ => fail | _ => assert (0 <= Rabs y) by apply Rabs_pos end end.

(* Closes `Rabs (v - real x value) <= b` from what computed_is_near says of both (Nv: value, Nb: bound), where the
  sums of
   absolute products are variables. *)
Ltac by_roundings Nv Nb :=
  cbn -[u32 h32] in Nv, Nb; unfold of_product, alpha, Q2R in *; cbn -[u32 h32] in Nv, Nb;
  rewrite ?Rabs_pos_eq in Nb by lra;
  replace u32 with (/ 16777216) in * by (unfold u32; simpl; lra);
  replace h32 with (/ 85070591730234615865843651857942052864) in * by (unfold h32; simpl; lra);
  lra.

(* (1 + u)^4 - 1 is a little more than 4 u: by less than 2^-20 of it. *)
Lemma four_roundings : alpha u32 4 <= (1 + / 1048576) * / 4194304.
Proof. unfold alpha. replace u32 with (/ 16777216) by (unfold u32; simpl; lra). simpl pow. lra. Qed.

(* For the table: numerators and denominators of the least constant and of the kernel's. *)
Definition shown (least kernel : Q) := (Qnum least, QDen least, Qnum kernel, QDen kernel).

(* A product of two numbers that are off by e and f. *)
Lemma product_moves p q p' q' e f :
  Rabs (p' - p) <= e -> Rabs (q' - q) <= f -> Rabs (p' * q' - p * q) <= Rabs p * f + Rabs q * e + e * f.
Proof.
  intros Hp Hq. replace (p' * q' - p * q) with ((p' - p) * (q' - q) + (p * (q' - q) + q * (p' - p))) by ring.
  assert (T := Rabs_triang ((p' - p) * (q' - q)) (p * (q' - q) + q * (p' - p))).
  assert (U := Rabs_triang (p * (q' - q)) (q * (p' - p))). rewrite !Rabs_mult in *.
  assert (A := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Hp Hq).
  assert (B := Rmult_le_compat_l _ _ _ (Rabs_pos p) Hq). assert (C := Rmult_le_compat_l _ _ _ (Rabs_pos q) Hp). lra.
Qed.
