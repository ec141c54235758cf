(* SPDX-License-Identifier: MIT *)
(* The one lemma behind gnomon's filters: how far a float expression may be off.

   An expression of + - * fma, magnitudes and negation, all on floats. `roundings` is the number of roundings that a
   term meets on the longest path, `permanent` the expression with all terms positive, in real arithmetic. Then

       |value - real| <= ((1 + u)^roundings - 1) permanent + underflow                              (computed_is_near)

   Assumed of the device: an operation's result is off by at most u of itself, and h; an operand is taken for a float
   that is at most h away. Devices.v proves both of IEEE 754's binary32 and binary64, with denormals kept or flushed.
   No overflow: a float here has no largest exponent. Whoever uses the lemma shows that nothing exceeds the range. *)
From Coq Require Import Reals QArith Qreals Lia Lra Psatz.
Open Scope R_scope.

Inductive expr :=
| Const (q : Q)      (* a float of the kernel's text *)
| Given (i k : nat)  (* input i; k: the roundings that it has met before *)
| Diff (i j : nat)   (* the difference of two inputs that have met none *)
| Times (q : Q) (a : expr)  (* q is a float of the kernel's text that no device flushes *)
| Neg (a : expr)
| Abs (a : expr)
| Add (a b : expr)
| Sub (a b : expr)
| Mul (a b : expr)
| Fma (a b c : expr).

Fixpoint roundings (e : expr) : nat :=
  match e with
  | Const _ => 0
  | Given _ k => k
  | Diff _ _ => 1
  | Neg a | Abs a => roundings a
  | Add a b | Sub a b => S (max (roundings a) (roundings b))
  | Times _ a => S (roundings a)
  | Mul a b => S (roundings a + roundings b)
  | Fma a b c => S (max (roundings a + roundings b) (roundings c))
  end.

Section Reals.
Variable x : nat -> R.

Fixpoint real (e : expr) : R :=
  match e with
  | Const q => Q2R q
  | Given i _ => x i
  | Diff i j => x i - x j
  | Times q a => Q2R q * real a
  | Neg a => - real a
  | Abs a => Rabs (real a)
  | Add a b => real a + real b
  | Sub a b => real a - real b
  | Mul a b => real a * real b
  | Fma a b c => real a * real b + real c
  end.

Fixpoint permanent (e : expr) : R :=
  match e with
  | Const q => Rabs (Q2R q)
  | Given i _ => Rabs (x i)
  | Diff i j => Rabs (x i - x j)
  | Times q a => Rabs (Q2R q) * permanent a
  | Neg a | Abs a => permanent a
  | Add a b | Sub a b => permanent a + permanent b
  | Mul a b => permanent a * permanent b
  | Fma a b c => permanent a * permanent b + permanent c
  end.

Lemma permanent_positive e : 0 <= permanent e.
Proof. induction e; simpl; try apply Rabs_pos; try lra; try nra. apply Rmult_le_pos; auto using Rabs_pos. Qed.

Lemma real_below_permanent e : Rabs (real e) <= permanent e.
Proof.
  assert (product : forall a b p q, Rabs a <= p -> Rabs b <= q -> Rabs (a * b) <= p * q).
  { intros; rewrite Rabs_mult; apply Rmult_le_compat; auto using Rabs_pos. }
  induction e; simpl; try lra.
  - apply product; auto; lra.
  - now rewrite Rabs_Ropp.
  - now rewrite Rabs_Rabsolu.
  - eapply Rle_trans; [apply Rabs_triang | lra].
  - unfold Rminus; eapply Rle_trans; [apply Rabs_triang |]; rewrite Rabs_Ropp; lra.
  - auto.
  - eapply Rle_trans; [apply Rabs_triang |]. specialize (product _ _ _ _ IHe1 IHe2). lra.
Qed.
End Reals.

Section Device.
Variables u h : R.
Hypotheses (u_positive : 0 <= u) (h_positive : 0 <= h).

(* rounds s v: the device may compute v where the real result of one operation is s. seen v w: it may take the operand v
   for w. *)
Variables rounds seen : R -> R -> Prop.
Hypothesis rounds_near : forall s v, rounds s v -> Rabs (v - s) <= u * Rabs s + h.
Hypothesis seen_near : forall v w, seen v w -> Rabs (w - v) <= h.

Definition alpha k := (1 + u) ^ k - 1.

Lemma alpha_positive k : 0 <= alpha k.
Proof. unfold alpha. assert (H := pow_R1_Rle (1 + u) k). lra. Qed.
Lemma alpha_grows j k : (j <= k)%nat -> alpha j <= alpha k.
Proof. intros; unfold alpha. assert ((1 + u) ^ j <= (1 + u) ^ k) by (apply Rle_pow; lia || lra). lra. Qed.
Lemma alpha_next k : alpha (S k) = (1 + u) * (1 + alpha k) - 1.
Proof. unfold alpha; simpl; ring. Qed.
Lemma alpha_sum j k : 1 + alpha (j + k) = (1 + alpha j) * (1 + alpha k).
Proof. unfold alpha; rewrite pow_add; ring. Qed.

Variable x : nat -> R.

Inductive computes : expr -> R -> Prop :=
| c_const q : computes (Const q) (Q2R q)
| c_given i k v : Rabs (v - x i) <= alpha k * Rabs (x i) -> computes (Given i k) v
| c_diff i j p q v : seen (x i) p -> seen (x j) q -> rounds (p - q) v -> computes (Diff i j) v
| c_times q a p s v : computes a p -> seen p s -> rounds (Q2R q * s) v -> computes (Times q a) v
| c_neg a p s : computes a p -> seen p s -> computes (Neg a) (- s)
| c_abs a p s : computes a p -> seen p s -> computes (Abs a) (Rabs s)
| c_add a b p q s t v : computes a p -> computes b q -> seen p s -> seen q t -> rounds (s + t) v -> computes (Add a b) v
| c_sub a b p q s t v : computes a p -> computes b q -> seen p s -> seen q t -> rounds (s - t) v -> computes (Sub a b) v
| c_mul a b p q s t v : computes a p -> computes b q -> seen p s -> seen q t -> rounds (s * t) v -> computes (Mul a b) v
| c_fma a b c p q r s t w v : computes a p -> computes b q -> computes c r -> seen p s -> seen q t -> seen r w ->
    rounds (s * t + w) v -> computes (Fma a b c) v.

(* What underflow can add. As an operand, input i may lose flushed i: nothing where it is 0 or no denormal, else h. *)
Variable flushed : nat -> R.
Hypothesis flushed_range : forall i, 0 <= flushed i <= h.
Hypothesis flushed_near : forall i k v w, (k <= 16)%nat -> Rabs (v - x i) <= alpha k * Rabs (x i) -> seen v w -> Rabs
  (w - v) <= flushed i.
Definition gap (e : expr) := match e with Given i k => if Nat.leb k 16 then flushed i else h | _ => h end.
Lemma gap_range e : 0 <= gap e <= h.
Proof. destruct e; simpl; try destruct (Nat.leb k 16); auto; lra. Qed.
Lemma gap_near e v w : computes e v -> seen v w -> Rabs (w - v) <= gap e.
Proof. 
  intros C S. destruct e; simpl; try (now apply seen_near). destruct (Nat.leb_spec k 16); [| now apply seen_near].
  inversion C; subst. eapply flushed_near; eassumption.
Qed.

Definition of_product (a b A B p q : R) := (1 + a) * A * q + (1 + b) * B * p + p * q.
Fixpoint lost (e : expr) : R :=
  match e with
  | Const _ | Given _ _ => 0
  | Diff _ _ => (1 + u) * (2 * h) + h
  | Times q a => (1 + u) * (Rabs (Q2R q) * (lost a + gap a)) + h
  | Neg a | Abs a => lost a + gap a
  | Add a b | Sub a b => (1 + u) * (lost a + gap a + (lost b + gap b)) + h
  | Mul a b =>
      (1 + u) * of_product (alpha (roundings a)) (alpha (roundings b)) (permanent x a) (permanent x b) (lost a + gap a)
                  (lost b + gap b) + h
  | Fma a b c =>
      (1 + u) * (of_product (alpha (roundings a)) (alpha (roundings b)) (permanent x a) (permanent x b) (lost a + gap a)
                   (lost b + gap b) + lost c + gap c) + h
  end.

Lemma of_product_positive a b A B p q : 0 <= a -> 0 <= b -> 0 <= A -> 0 <= B -> 0 <= p -> 0 <= q -> 0 <= of_product a
  b A B p q.
Proof.
  intros. unfold of_product. assert (0 <= (1 + a) * A) by (apply Rmult_le_pos; lra).
  assert (0 <= (1 + b) * B) by (apply Rmult_le_pos; lra). assert (0 <= (1 + a) * A * q) by (apply Rmult_le_pos; lra).
  assert (0 <= (1 + b) * B * p) by (apply Rmult_le_pos; lra). assert (0 <= p * q) by (apply Rmult_le_pos; lra). lra.
Qed.
Lemma of_product_grows a b A B p q A' B' p' q' : 0 <= a -> 0 <= b -> 0 <= A <= A' -> 0 <= B <= B' -> 0 <= p <= p' ->
  0 <= q <= q' -> of_product a b A B p q <= of_product a b A' B' p' q'.
Proof.
  intros. unfold of_product. assert ((1 + a) * A <= (1 + a) * A') by (apply Rmult_le_compat_l; lra).
  assert ((1 + b) * B <= (1 + b) * B') by (apply Rmult_le_compat_l; lra).
  assert (0 <= (1 + a) * A) by (apply Rmult_le_pos; lra). assert (0 <= (1 + b) * B) by (apply Rmult_le_pos; lra).
  assert ((1 + a) * A * q <= (1 + a) * A' * q') by (apply Rmult_le_compat; lra).
  assert ((1 + b) * B * p <= (1 + b) * B' * p') by (apply Rmult_le_compat; lra).
  assert (p * q <= p' * q') by (apply Rmult_le_compat; lra). lra.
Qed.
Lemma lost_positive e : 0 <= lost e.
Proof.
  assert (P := permanent_positive x). assert (A := alpha_positive). assert (G := gap_range).
  assert (up : forall p, 0 <= p -> 0 <= (1 + u) * p + h) by (intros; assert (0 <= (1 + u) * p) by (apply Rmult_le_pos;
    lra); lra).
  induction e; cbn [lost]; try lra; try (apply up).
  - lra.
  - specialize (G e). apply Rmult_le_pos; auto using Rabs_pos. lra.
  - specialize (G e). lra.
  - specialize (G e). lra.
  - assert (G1 := G e1). assert (G2 := G e2). lra.
  - assert (G1 := G e1). assert (G2 := G e2). lra.
  - assert (G1 := G e1). assert (G2 := G e2). apply of_product_positive; auto; lra.
  - assert (G1 := G e1). assert (G2 := G e2). assert (G3 := G e3).
    assert (O := of_product_positive (alpha (roundings e1)) (alpha (roundings e2)) (permanent x e1) (permanent x e2)
      (lost e1 + gap e1) (lost e2 + gap e2) ltac:(auto) ltac:(auto) ltac:(auto) ltac:(auto) ltac:(lra) ltac:(lra)). lra.
Qed.

(* One more rounding. *)
Lemma after_rounding s v S a P w :
  rounds s v -> Rabs (s - S) <= a * P + w -> Rabs S <= P -> Rabs (v - S) <= ((1 + u) * (1 + a) - 1) * P + ((1 + u) * w
    + h).
Proof.
  intros Hr Hs HS. apply rounds_near in Hr.
  assert (Rabs s <= Rabs (s - S) + Rabs S).
  { replace s with ((s - S) + S) at 1 by ring. apply Rabs_triang. }
  assert (Rabs (v - S) <= Rabs (v - s) + Rabs (s - S)).
  { replace (v - S) with ((v - s) + (s - S)) by ring. apply Rabs_triang. }
  assert (u * Rabs s <= u * (P + a * P + w)) by (apply Rmult_le_compat_l; lra). lra.
Qed.

Lemma after_seen e v w S b : computes e v -> seen v w -> Rabs (v - S) <= b -> Rabs (w - S) <= b + gap e.
Proof.
  intros C H Hv. apply (gap_near _ _ _ C) in H.
  replace (w - S) with ((w - v) + (v - S)) by ring. eapply Rle_trans; [apply Rabs_triang | lra].
Qed.

Lemma product_near p q A B a b PA PB MA MB wa wb :
  0 <= a -> 0 <= b -> 0 <= wa -> 0 <= wb -> Rabs A <= PA -> Rabs B <= PB -> PA <= MA -> PB <= MB ->
  Rabs (p - A) <= a * PA + wa -> Rabs (q - B) <= b * PB + wb ->
  Rabs (p * q - A * B) <= ((1 + a) * (1 + b) - 1) * (PA * PB) + of_product a b MA MB wa wb.
Proof.
  intros a0 b0 wa0 wb0 HA HB HMA HMB Hp Hq. unfold of_product.
  assert (PA0 : 0 <= PA) by (eapply Rle_trans; [apply Rabs_pos | eassumption]).
  assert (PB0 : 0 <= PB) by (eapply Rle_trans; [apply Rabs_pos | eassumption]).
  replace (p * q - A * B) with ((p - A) * (q - B) + (A * (q - B) + B * (p - A))) by ring.
  assert (E1 : Rabs ((p - A) * (q - B)) <= (a * PA + wa) * (b * PB + wb)).
  { rewrite Rabs_mult; apply Rmult_le_compat; auto using Rabs_pos. }
  assert (E2 : Rabs (A * (q - B)) <= PA * (b * PB + wb)).
  { rewrite Rabs_mult; apply Rmult_le_compat; auto using Rabs_pos. }
  assert (E3 : Rabs (B * (p - A)) <= PB * (a * PA + wa)).
  { rewrite Rabs_mult; apply Rmult_le_compat; auto using Rabs_pos. }
  eapply Rle_trans; [apply Rabs_triang |].
  assert (E4 := Rabs_triang (A * (q - B)) (B * (p - A))).
  assert ((1 + a) * PA * wb <= (1 + a) * MA * wb).
  { apply Rmult_le_compat_r; auto. apply Rmult_le_compat_l; lra. }
  assert ((1 + b) * PB * wa <= (1 + b) * MB * wa).
  { apply Rmult_le_compat_r; auto. apply Rmult_le_compat_l; lra. }
  lra.
Qed.

Theorem computed_is_off e v :
  computes e v -> Rabs (v - real x e) <= alpha (roundings e) * permanent x e + lost e.
Proof.
  assert (P := permanent_positive x). assert (B := real_below_permanent x).
  assert (A := alpha_positive).
  assert (grow : forall j k p, (j <= k)%nat -> 0 <= p -> alpha j * p <= alpha k * p).
  { intros; apply Rmult_le_compat_r; auto using alpha_grows. }
  assert (product : forall a b p q s t, computes a p -> computes b q ->
    Rabs (p - real x a) <= alpha (roundings a) * permanent x a + lost a ->
    Rabs (q - real x b) <= alpha (roundings b) * permanent x b + lost b -> seen p s -> seen q t ->
    Rabs (s * t - real x a * real x b) <= alpha (roundings a + roundings b) * (permanent x a * permanent x b) +
      of_product (alpha (roundings a)) (alpha (roundings b)) (permanent x a) (permanent x b) (lost a + gap a) (lost b
        + gap b)).
  { intros a b p q s t Ca Cb Ha Hb Hs Ht.
    replace (alpha (roundings a + roundings b)) with ((1 + alpha (roundings a)) * (1 + alpha (roundings b)) - 1)
      by (rewrite <- alpha_sum; ring).
    assert (Ga := gap_range a). assert (Gb := gap_range b). assert (Za := lost_positive a). assert (Zb :=
      lost_positive b).
    apply product_near; auto; try lra.
    - eapply Rle_trans; [apply (after_seen _ _ _ _ _ Ca Hs Ha) | lra].
    - eapply Rle_trans; [apply (after_seen _ _ _ _ _ Cb Ht Hb) | lra]. }
  intros C. induction C; simpl; rewrite ?alpha_next.
  - rewrite Rminus_diag_eq, Rabs_R0 by reflexivity. unfold alpha. simpl. lra.
  - lra.
  - apply after_rounding with (s := p - q); auto; [| lra].
    apply seen_near in H. apply seen_near in H0.
    replace (p - q - (x i - x j)) with ((p - x i) + - (q - x j)) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp. unfold alpha. simpl. lra.
  - assert (E := after_seen _ _ _ _ _ C H IHC).
    apply after_rounding with (s := Q2R q * s); auto.
    + replace (Q2R q * s - Q2R q * real x a) with (Q2R q * (s - real x a)) by ring. rewrite Rabs_mult.
      assert (G := Rmult_le_compat_l _ _ _ (Rabs_pos (Q2R q)) E). lra.
    + rewrite Rabs_mult. apply Rmult_le_compat_l; auto using Rabs_pos.
  - assert (E := after_seen _ _ _ _ _ C H IHC).
    replace (- s - - real x a) with (- (s - real x a)) by ring. rewrite Rabs_Ropp. lra.
  - assert (E := after_seen _ _ _ _ _ C H IHC).
    eapply Rle_trans; [apply Rabs_triang_inv2 |]. lra.
  - assert (E1 := after_seen _ _ _ _ _ C1 H IHC1). assert (E2 := after_seen _ _ _ _ _ C2 H0 IHC2).
    apply after_rounding with (s := s + t); auto.
    + replace (s + t - (real x a + real x b)) with ((s - real x a) + (t - real x b)) by ring.
      eapply Rle_trans; [apply Rabs_triang |].
      assert (G1 := grow (roundings a) (max (roundings a) (roundings b)) (permanent x a) ltac:(lia) (P a)).
      assert (G2 := grow (roundings b) (max (roundings a) (roundings b)) (permanent x b) ltac:(lia) (P b)). lra.
    + eapply Rle_trans; [apply Rabs_triang |]. specialize (B a) as Ba. specialize (B b) as Bb. lra.
  - assert (E1 := after_seen _ _ _ _ _ C1 H IHC1). assert (E2 := after_seen _ _ _ _ _ C2 H0 IHC2).
    apply after_rounding with (s := s - t); auto.
    + replace (s - t - (real x a - real x b)) with ((s - real x a) + - (t - real x b)) by ring.
      eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp.
      assert (G1 := grow (roundings a) (max (roundings a) (roundings b)) (permanent x a) ltac:(lia) (P a)).
      assert (G2 := grow (roundings b) (max (roundings a) (roundings b)) (permanent x b) ltac:(lia) (P b)). lra.
    + unfold Rminus. eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp.
      specialize (B a) as Ba. specialize (B b) as Bb. lra.
  - apply after_rounding with (s := s * t); auto.
    + apply product with (p := p) (q := q); auto.
    + rewrite Rabs_mult; apply Rmult_le_compat; auto using Rabs_pos.
  - assert (E3 := after_seen _ _ _ _ _ C3 H1 IHC3).
    assert (E := product a b p q s t C1 C2 IHC1 IHC2 H H0).
    set (k := max (roundings a + roundings b) (roundings c)).
    assert (Pab : 0 <= permanent x a * permanent x b) by (apply Rmult_le_pos; auto).
    assert (G1 := grow (roundings a + roundings b)%nat k (permanent x a * permanent x b) ltac:(lia) Pab).
    assert (G2 := grow (roundings c) k (permanent x c) ltac:(lia) (P c)).
    apply after_rounding with (s := s * t + w); auto.
    + replace (s * t + w - (real x a * real x b + real x c)) with
        ((s * t - real x a * real x b) + (w - real x c)) by ring.
      eapply Rle_trans; [apply Rabs_triang |]. lra.
    + eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_mult.
      assert (Rabs (real x a) * Rabs (real x b) <= permanent x a * permanent x b).
      { apply Rmult_le_compat; auto using Rabs_pos. }
      specialize (B c) as Bc. lra.
Qed.

(* The same by numbers, where input i does not exceed m i and no difference d i j. *)
Variable m : nat -> R.
Variable d : nat -> nat -> R.
Fixpoint largest (e : expr) : R :=
  match e with
  | Const q => Rabs (Q2R q)
  | Given i _ => m i
  | Diff i j => d i j
  | Times q a => Rabs (Q2R q) * largest a
  | Neg a | Abs a => largest a
  | Add a b | Sub a b => largest a + largest b
  | Mul a b => largest a * largest b
  | Fma a b c => largest a * largest b + largest c
  end.
Fixpoint underflow (e : expr) : R :=
  match e with
  | Const _ | Given _ _ => 0
  | Diff _ _ => (1 + u) * (2 * h) + h
  | Times q a => (1 + u) * (Rabs (Q2R q) * (underflow a + gap a)) + h
  | Neg a | Abs a => underflow a + gap a
  | Add a b | Sub a b => (1 + u) * (underflow a + gap a + (underflow b + gap b)) + h
  | Mul a b =>
      (1 + u) * of_product (alpha (roundings a)) (alpha (roundings b)) (largest a) (largest b) (underflow a + gap a)
                  (underflow b + gap b) + h
  | Fma a b c =>
      (1 + u) * (of_product (alpha (roundings a)) (alpha (roundings b)) (largest a) (largest b) (underflow a + gap a)
                   (underflow b + gap b) + underflow c + gap c) + h
  end.

Fixpoint within (e : expr) : Prop :=
  match e with
  | Const _ => True
  | Given i _ => Rabs (x i) <= m i
  | Diff i j => Rabs (x i - x j) <= d i j
  | Times _ a | Neg a | Abs a => within a
  | Add a b | Sub a b | Mul a b => within a /\ within b
  | Fma a b c => within a /\ within b /\ within c
  end.

Lemma permanent_below_largest e : within e -> permanent x e <= largest e.
Proof.
  assert (P := permanent_positive x).
  induction e; simpl; intros H; try tauto; try (destruct H; specialize (IHe1 ltac:(tauto)); specialize (IHe2
    ltac:(tauto))).
  - lra.
  - specialize (IHe H). apply Rmult_le_compat_l; auto using Rabs_pos.
  - lra.
  - lra.
  - specialize (P e1) as P1; specialize (P e2) as P2. now apply Rmult_le_compat.
  - destruct H0. specialize (IHe3 ltac:(tauto)). specialize (P e1) as P1; specialize (P e2) as P2.
    assert (permanent x e1 * permanent x e2 <= largest e1 * largest e2) by (now apply Rmult_le_compat). lra.
Qed.

Lemma lost_below e : within e -> lost e <= underflow e.
Proof.
  assert (P := permanent_positive x). assert (A := alpha_positive). assert (Z := lost_positive). assert (G :=
    gap_range).
  assert (grow : forall p q, p <= q -> (1 + u) * p <= (1 + u) * q) by (intros; apply Rmult_le_compat_l; lra).
  induction e; cbn [lost underflow within]; intros H; try lra.
  - specialize (IHe H). apply Rplus_le_compat_r, grow, Rmult_le_compat_l; auto using Rabs_pos. lra.
  - specialize (IHe H). lra.
  - specialize (IHe H). lra.
  - destruct H. specialize (IHe1 ltac:(auto)). specialize (IHe2 ltac:(auto)). apply Rplus_le_compat_r, grow. lra.
  - destruct H. specialize (IHe1 ltac:(auto)). specialize (IHe2 ltac:(auto)). apply Rplus_le_compat_r, grow. lra.
  - destruct H as [H1 H2]. specialize (IHe1 H1). specialize (IHe2 H2). apply Rplus_le_compat_r, grow.
    specialize (Z e1) as Z1. specialize (Z e2) as Z2. specialize (G e1) as G1. specialize (G e2) as G2.
    apply of_product_grows; auto using permanent_below_largest; lra.
  - destruct H as [H1 [H2 H3]]. specialize (IHe1 H1). specialize (IHe2 H2). specialize (IHe3 H3).
    apply Rplus_le_compat_r, grow. specialize (Z e1) as Z1. specialize (Z e2) as Z2. specialize (G e1) as G1.
      specialize (G e2) as G2.
    assert (O := of_product_grows (alpha (roundings e1)) (alpha (roundings e2)) (permanent x e1) (permanent x e2)
      (lost e1 + gap e1) (lost e2 + gap e2) (largest e1) (largest e2) (underflow e1 + gap e1) (underflow e2 + gap e2)
      ltac:(auto) ltac:(auto) ltac:(auto using permanent_below_largest) ltac:(auto using permanent_below_largest)
      ltac:(lra) ltac:(lra)). lra.
Qed.
Lemma underflow_positive e : within e -> 0 <= underflow e.
Proof. intros H. assert (L := lost_below e H). assert (Z := lost_positive e). lra. Qed.

Theorem computed_is_near e v :
  within e -> computes e v -> Rabs (v - real x e) <= alpha (roundings e) * permanent x e + underflow e.
Proof. intros L C. assert (N := computed_is_off e v C). assert (U := lost_below e L). lra. Qed.
End Device.

(* One limit for all inputs, and one for all differences. *)
Definition within_limits x (m d : R) := within x (fun _ => m) (fun _ _ => d).
