(* SPDX-License-Identifier: MIT *)
(* A filter compares |value| with a computed bound, constant * size, where size is the value's permanent as the kernel
   computes it, and at least `least`. Where the constant is not below least_constant, the value is off by at most the
   bound (filter_is_right), so that a value beyond it has the sign of the real value (sign_is_right).

   Numbers are rationals here, so that Coq computes them. *)
From Coq Require Import Reals QArith Qreals Qabs Lia Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices.

(* Roundings.v's numbers, in rationals. *)
Section Rationals.
Open Scope Q_scope.
Variables u h m d : Q.
Fixpoint powerQ (k : nat) : Q := match k with O => 1 | S k => Qred ((1 + u) * powerQ k) end.
Definition alphaQ k := powerQ k - 1.
Fixpoint largestQ (e : expr) : Q :=
  match e with
  | Const q => Qabs q
  | Given _ _ => m
  | Diff _ _ => d
  | Times q a => Qred (Qabs q * largestQ a)
  | Neg a | Abs a => largestQ a
  | Add a b | Sub a b => Qred (largestQ a + largestQ b)
  | Mul a b => Qred (largestQ a * largestQ b)
  | Fma a b c => Qred (largestQ a * largestQ b + largestQ c)
  end.
Definition of_productQ (a b A B p q : Q) := (1 + a) * A * q + (1 + b) * B * p + p * q.
Fixpoint underflowQ (e : expr) : Q :=
  match e with
  | Const _ | Given _ _ => 0
  | Diff _ _ => Qred ((1 + u) * (2 * h) + h)
  | Times q a => Qred ((1 + u) * (Qabs q * (underflowQ a + h)) + h)
  | Neg a | Abs a => Qred (underflowQ a + h)
  | Add a b | Sub a b => Qred ((1 + u) * (underflowQ a + underflowQ b + 2 * h) + h)
  | Mul a b =>
      Qred ((1 + u) * of_productQ (alphaQ (roundings a)) (alphaQ (roundings b)) (largestQ a) (largestQ b)
                        (underflowQ a + h) (underflowQ b + h) + h)
  | Fma a b c =>
      Qred ((1 + u) * (of_productQ (alphaQ (roundings a)) (alphaQ (roundings b)) (largestQ a) (largestQ b)
                         (underflowQ a + h) (underflowQ b + h) + underflowQ c + h) + h)
  end.

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
  repeat (rewrite Q2R_red || rewrite Q2R_plus || rewrite Q2R_minus || rewrite Q2R_mult || rewrite Q2R_1 || rewrite Q2R_2 ||
          rewrite Q2R_0').

Section Reals.
Variables u h m d : Q.
Lemma power_is k : Q2R (powerQ u k) = (1 + Q2R u) ^ k.
Proof. induction k; cbn [powerQ pow]; to_reals; [reflexivity | now rewrite IHk]. Qed.
Lemma alpha_is k : Q2R (alphaQ u k) = alpha (Q2R u) k.
Proof. unfold alphaQ, alpha. to_reals. now rewrite power_is. Qed.
Lemma largest_is e : Q2R (largestQ m d e) = largest (Q2R m) (Q2R d) e.
Proof. induction e; cbn [largestQ largest]; to_reals; rewrite ?Q2R_abs; congruence. Qed.
Lemma underflow_is e : Q2R (underflowQ u h m d e) = underflow (Q2R u) (Q2R h) (Q2R m) (Q2R d) e.
Proof.
  induction e; cbn [underflowQ underflow]; unfold of_productQ, of_product; to_reals; rewrite ?alpha_is, ?largest_is, ?Q2R_abs, ?IHe, ?IHe1, ?IHe2, ?IHe3;
    reflexivity.
Qed.
End Reals.

Section Filter.
Variables u h m d : Q.
Variables rounds seen : R -> R -> Prop.
Hypotheses (u0 : 0 <= Q2R u) (h0 : 0 <= Q2R h).
Hypothesis rounds_near : forall s v, rounds s v -> Rabs (v - s) <= Q2R u * Rabs s + Q2R h.
Hypothesis seen_near : forall v w, seen v w -> Rabs (w - v) <= Q2R h.
Variable x : nat -> R.
Let computed := computes (Q2R u) rounds seen x.
Let limited := within_limits x (Q2R m) (Q2R d).

Theorem filter_is_right value size least constant v s t b :
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  is_enough u h m d value size least constant = true ->
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
  assert (Nv := computed_is_near (Q2R u) (Q2R h) u0 h0 rounds seen rounds_near seen_near x (Q2R m) (Q2R d) value v Lv Cv).
  assert (Ns := computed_is_near (Q2R u) (Q2R h) u0 h0 rounds seen rounds_near seen_near x (Q2R m) (Q2R d) size s Ls Cs).
  assert (Av := alpha_positive (Q2R u) u0 (roundings value)).
  assert (As := alpha_positive (Q2R u) u0 (roundings size)).
  assert (U := underflow_positive (Q2R u) (Q2R h) u0 h0 x (Q2R m) (Q2R d) size Ls).
  unfold rate in *. rewrite ?Q2R_red in *.
  assert (nonzero : ~ (1 - alphaQ u (roundings size) == 0)%Q).
  { intro H. assert (H' : (alphaQ u (roundings size) == 1)%Q) by (rewrite <- Qplus_0_r, <- H; ring).
    rewrite H' in E5'. now apply Qlt_irrefl in E5'. }
  repeat rewrite Q2R_mult in E6. repeat rewrite Q2R_mult in E7.
  rewrite ?Q2R_plus, ?Q2R_minus, ?Q2R_mult, ?Q2R_1, ?Q2R_red in *.
  rewrite ?Q2R_div, ?Q2R_minus, ?Q2R_1, ?alpha_is in E6, E7 by exact nonzero.
  rewrite Q2R_plus in E7. rewrite !underflow_is in E7. rewrite Q2R_0' in E1, E2.
  rewrite Hs in Ns. assert (HPs : alpha (Q2R u) (roundings value) * permanent x value <=
    alpha (Q2R u) (roundings value) * permanent x size) by (now apply Rmult_le_compat_l).
  set (P := permanent x size) in *. set (a := alpha (Q2R u) (roundings value)) in *.
  set (g := alpha (Q2R u) (roundings size)) in *. set (Us := underflow _ _ _ _ size) in *.
  set (Uv := underflow _ _ _ _ value) in *. set (A := a / (1 - g)) in *.
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

(* Where a kernel adds further terms to the error, or is to err by at most a given rest: the error is at most constant s +
   rest. *)
Theorem error_is_below value size constant rest v s :
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  is_within u h m d value size constant rest = true ->
  computed value v -> computed size s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s + Q2R rest.
Proof.
  intros Lv Ls Hp Hs E Cv Cs Hs0. unfold is_within in E. rewrite !Bool.andb_true_iff, Bool.negb_true_iff in E.
  destruct E as [[E5 E6] E7]. apply Qle_bool_imp_le, Qle_Rle in E6, E7.
  assert (E5' : (alphaQ u (roundings size) < 1)%Q).
  { apply Qnot_le_lt. intro H. apply Qle_bool_iff in H. congruence. }
  assert (E5'' := Qlt_Rlt _ _ E5'). rewrite alpha_is, Q2R_1 in E5''.
  assert (Nv := computed_is_near (Q2R u) (Q2R h) u0 h0 rounds seen rounds_near seen_near x (Q2R m) (Q2R d) value v Lv Cv).
  assert (Ns := computed_is_near (Q2R u) (Q2R h) u0 h0 rounds seen rounds_near seen_near x (Q2R m) (Q2R d) size s Ls Cs).
  assert (Av := alpha_positive (Q2R u) u0 (roundings value)).
  unfold rate in *. assert (nonzero : ~ (1 - alphaQ u (roundings size) == 0)%Q).
  { intro H. assert (H' : (alphaQ u (roundings size) == 1)%Q) by (rewrite <- Qplus_0_r, <- H; ring).
    rewrite H' in E5'. now apply Qlt_irrefl in E5'. }
  rewrite Q2R_plus, Q2R_mult in E7. rewrite Q2R_red, Q2R_div, Q2R_minus, Q2R_1, !alpha_is in E6, E7 by exact nonzero.
  rewrite !underflow_is in E7. rewrite Hs in Ns. apply between in Ns.
  assert (HPs : alpha (Q2R u) (roundings value) * permanent x value <=
    alpha (Q2R u) (roundings value) * permanent x size) by (now apply Rmult_le_compat_l).
  set (P := permanent x size) in *. set (a := alpha (Q2R u) (roundings value)) in *.
  set (g := alpha (Q2R u) (roundings size)) in *. set (Us := underflow _ _ _ _ size) in *.
  set (Uv := underflow _ _ _ _ value) in *. set (A := a / (1 - g)) in *.
  assert (HP : a * P <= A * (s + Us)).
  { unfold A. replace (a * P) with (a / (1 - g) * ((1 - g) * P)) by (field; lra).
    apply Rmult_le_compat_l; [| lra]. unfold Rdiv. apply Rmult_le_pos; auto. left; apply Rinv_0_lt_compat; lra. }
  assert (A * s <= Q2R constant * s) by (apply Rmult_le_compat_r; lra). lra.
Qed.

Corollary sign_is_right value size least constant v s t b :
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  is_enough u h m d value size least constant = true ->
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

Section Devices.
Variable x : nat -> R.
Variables m d : Q.
Let limited := within_limits x (Q2R m) (Q2R d).

Theorem float_filter value size least constant v s t b :
  is_enough u32Q h32Q m d value size least constant = true ->
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  computes32 x value v -> computes32 x size s -> Q2R least <= s -> seen32 s t -> rounds32 (Q2R constant * t) b ->
  b < Rabs v -> (0 < v <-> 0 < real x value) /\ real x value <> 0.
Proof.
  unfold computes32. rewrite <- u32_is. intros. 
  eapply (sign_is_right u32Q h32Q m d rounds32 seen32); try eassumption; rewrite ?u32_is, ?h32_is;
    auto using rounds32_near, seen32_near; unfold u32, h32; apply bpow_ge_0.
Qed.

Theorem float_error value size constant rest v s :
  is_within u32Q h32Q m d value size constant rest = true ->
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  computes32 x value v -> computes32 x size s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s + Q2R rest.
Proof.
  unfold computes32. rewrite <- u32_is. intros.
  eapply (error_is_below u32Q h32Q m d rounds32 seen32); try eassumption; rewrite ?u32_is, ?h32_is;
    auto using rounds32_near, seen32_near; unfold u32, h32; apply bpow_ge_0.
Qed.

(* Where no operand and no result is below 2^-126, unless it is 0. *)
Theorem float_error_of_normal_numbers value size constant v s :
  is_within u32Q 0 m d value size constant 0 = true ->
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  computes_normal x value v -> computes_normal x size s -> 0 <= s -> Rabs (v - real x value) <= Q2R constant * s.
Proof.
  unfold computes_normal. rewrite <- u32_is. intros. assert (zero := Q2R_0').
  replace (Q2R constant * s) with (Q2R constant * s + Q2R 0) by (rewrite zero; ring).
  eapply (error_is_below u32Q 0 m d rounds_normal seen64); try eassumption; rewrite ?u32_is, ?zero;
    auto using rounds_normal_near, seen64_near; try lra; unfold u32; apply bpow_ge_0.
Qed.

(* The same without a size: the error of any expression. *)
Theorem error_of_normal_numbers e v :
  limited e -> computes_normal x e v -> Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e.
Proof.
  intros L C. assert (u0 : 0 <= u32) by apply bpow_ge_0.
  assert (N := computed_is_near u32 0 u0 (Rle_refl 0) rounds_normal seen64 rounds_normal_near seen64_near x (Q2R m) (Q2R d)
    e v L C).
  assert (U : underflow u32 0 (Q2R m) (Q2R d) e = 0).
  { clear. induction e; cbn [underflow]; unfold of_product; rewrite ?IHe, ?IHe1, ?IHe2, ?IHe3; ring. }
  lra.
Qed.

Theorem double_filter value size constant v s b :
  is_enough u64Q 0 m d value size 0 constant = true ->
  limited value -> limited size -> permanent x value <= permanent x size -> real x size = permanent x size ->
  computes64 x value v -> computes64 x size s -> 0 <= s -> rounds64 (Q2R constant * s) b ->
  b < Rabs v -> (0 < v <-> 0 < real x value) /\ real x value <> 0.
Proof.
  unfold computes64. rewrite <- u64_is. intros. assert (zero := Q2R_0').
  eapply (sign_is_right u64Q 0 m d rounds64 seen64) with (t := s) (least := 0%Q); try eassumption; rewrite ?u64_is, ?zero;
    auto using rounds64_near, seen64_near; try lra; try reflexivity. unfold u64; apply bpow_ge_0.
Qed.
End Devices.

(* ---- Where nothing underflows -------------------------------------------------------------------------------------- *)

Definition any : Q := 2 ^ 129.
Definition computed x e v := computes_normal x e v /\ within_limits x (Q2R any) (Q2R any) e.
Lemma near x e v : computed x e v -> Rabs (v - real x e) <= alpha u32 (roundings e) * permanent x e.
Proof. intros [C L]. exact (error_of_normal_numbers x any any e v L C). Qed.
Lemma alpha_below k : (k <= 16)%nat -> alpha u32 k <= INR k * (1 + / 1048576) * / 16777216.
Proof.
  intros H. unfold alpha. replace u32 with (/ 16777216) by (unfold u32; simpl; lra).
  do 17 (destruct k as [| k]; [simpl pow; simpl INR; lra |]). lia.
Qed.
Lemma alpha_at_least k : 0 <= alpha u32 k.
Proof. apply alpha_positive. apply bpow_ge_0. Qed.

(* One operation at a time, where the sum of absolute products says too little. *)
Lemma one_rounding s v : rounds_normal s v -> Rabs (v - s) <= / 16777216 * Rabs s.
Proof. intros R. apply rounds_normal_near in R. replace u32 with (/ 16777216) in R by (unfold u32; simpl; lra). lra. Qed.
Lemma given_is x i v : computed x (Given i 0) v -> v = x i.
Proof.
  intros [C _]. inversion C as [ | ? ? ? H | | | | | | | | ]; subst. unfold alpha in H. simpl in H.
  replace (1 - 1) with 0 in H by ring. rewrite Rmult_0_l in H. apply between in H. lra.
Qed.
Ltac by_step C := destruct C as [C L]; cbn [within_limits] in L; inversion C; subst;
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

(* The same in double. *)
Definition any64 : Q := 2 ^ 1025.
Definition computed64 x e v := computes64 x e v /\ within_limits x (Q2R any64) (Q2R any64) e.
Lemma near64 x e v : computed64 x e v -> Rabs (v - real x e) <= alpha u64 (roundings e) * permanent x e.
Proof.
  intros [C L]. assert (u0 : 0 <= u64) by apply bpow_ge_0. unfold computes64 in C.
  assert (N := computed_is_near u64 0 u0 (Rle_refl 0) rounds64 seen64 rounds64_near seen64_near x _ _ e v L C).
  assert (U : underflow u64 0 (Q2R any64) (Q2R any64) e = 0).
  { clear. induction e; cbn [underflow]; unfold of_product; rewrite ?IHe, ?IHe1, ?IHe2, ?IHe3; ring. }
  lra.
Qed.
Lemma alpha64_below k : (k <= 16)%nat -> alpha u64 k <= INR k * (1 + / 1048576) * / 9007199254740992.
Proof.
  intros H. unfold alpha. replace u64 with (/ 9007199254740992) by (unfold u64; simpl; lra).
  do 17 (destruct k as [| k]; [simpl pow; simpl INR; lra |]). lia.
Qed.
Lemma alpha64_at_least k : 0 <= alpha u64 k.
Proof. apply alpha_positive. apply bpow_ge_0. Qed.

(* Closes `permanent x value <= permanent x size`, where both are equal, and `real x size = permanent x size`. *)
Ltac same_products :=
  intros; cbn; repeat (rewrite Rabs_mult || rewrite Rabs_Rabsolu || rewrite (Rabs_pos_eq (Rabs _ * _ + _)));
  auto using Rabs_pos; try apply Req_le; ring.

(* The sizes in a goal are not negative. *)
Ltac sizes_are_positive :=
  repeat match goal with |- context [Rabs ?y] => lazymatch goal with
    | H : 0 <= Rabs y |- _ => fail | _ => assert (0 <= Rabs y) by apply Rabs_pos end end.

(* Closes `Rabs (v - real x value) <= b` from what computed_is_near says of both (Nv: value, Nb: bound), where the sums of
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
