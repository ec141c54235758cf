(* SPDX-License-Identifier: MIT *)
(* hull_bounds.clh: the sides of rectangles and the heights of hulls (docs/numerics.md, 5). H and W are what `h` and `w`
   are off from by at most `error` and `error_w`, E is what a point is off by:
     low_side_is_below, high_side_is_above       no side made of a vertex with |w| > 2 error_w cuts H / W -+ E;
     low_side_in_front, high_side_in_front       none by the slack of a hull that is wholly in front: 7.96 u of 8 u;
     low_side_is_below_parallel, ..._above_...   none under a direction, where 2 u would do: it is the same number;
     low_height_is_below, high_height_is_above   1 / W lies between both heights: 5.98 u of 6 u;
     no_higher, no_lower                         near W = 0 the sign of h +- slack is that of H - X W for all X.

   Assumed: a quotient is off by 2.5 ulp and by 2^-126, and one of positive numbers is not negative; `point_error` exceeds E
   by 2 u of itself (frame_errors.v: 10.1 u for 6.1 u; both are 0 for a camera), and so does height_error. In perspective
   `error` and error_w are 2^-90 at least (projection.v), error_w is 9 u |w| at least and up to 2^24 times `error` (a light's
   row has an offset of a fifth at least, frame_fit.v; a camera's adds 2^-20 of all its entries, projection.h), and |w| is up
   to 2^40 (vertices from 1e12 on are out of range); under a direction `error` is 2^-24 at least. Denormals may be kept or
   flushed: what that takes is within the hundredth of `error`. A slack's own roundings take 12 u of the 1 %; the rest is
   needed by 8 u and 6 u, which are proved with .99 % of it. Orders that rounding keeps: a hull's least product is at most
   each of them, its slack is made of the largest `size` (2^-126 less than a product at most, where that is flushed) and of
   the largest `nearest`. Overflow: an infinite slack gives no bound. *)
From Coq Require Import Reals QArith Qreals Lra Lia Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition h := 0%nat.
Definition w := 1%nat.
Definition inverse := 2%nat.
Definition error := 3%nat.
Definition error_w := 4%nat.
Definition nearest := 5%nat.
Definition size := 6%nat.
Definition reach := 7%nat.
Definition point_error := 8%nat.
Definition quotient_1 := 9%nat.
Definition quotient_2 := 10%nat.
Definition quotient_1_over := Given h 0.
Definition quotient_1_under := Given w 0.
Definition quotient_2_over :=
  Add (Given error 0) (Mul (Abs (Given quotient_1 0)) (Given error_w 0)).
Definition quotient_2_under :=
  Sub (Abs (Given w 0)) (Given error_w 0).
Definition slack :=
  Times (4236247 # 4194304) (Add (Given quotient_2 0) (Times (1 # 2097152) (Abs (Given quotient_1 0)))).
Definition low :=
  Sub (Sub (Given quotient_1 0) slack) (Given point_error 0).
Definition high :=
  Add (Add (Given quotient_1 0) slack) (Given point_error 0).
Definition product :=
  Mul (Given h 0) (Given inverse 0).
Definition in_front :=
  Times (4236247 # 4194304) (Add (Mul (Add (Given error 0) (Mul (Given error_w 0) (Given size 0))) (Mul (Add (Const
    (1 # 1)) (Times (2 # 1) (Mul (Given error_w 0) (Given nearest 0)))) (Given nearest 0))) (Times (1 # 2097152)
    (Given size 0))).
Definition low_in_front :=
  Sub (Sub product in_front) (Given point_error 0).
Definition high_in_front :=
  Add (Add in_front product) (Given point_error 0).
Definition low_parallel :=
  Sub (Sub (Given h 0) (Times (4236247 # 4194304) (Add (Given error 0) (Times (1 # 2097152) (Abs (Given h 0))))))
    (Given point_error 0).
Definition high_parallel :=
  Add (Add (Given h 0) (Times (4236247 # 4194304) (Add (Given error 0) (Times (1 # 2097152) (Abs (Given h 0))))))
    (Given point_error 0).
Definition near_zero :=
  Times (4236247 # 4194304) (Add (Given error 0) (Mul (Add (Abs (Given w 0)) (Given error_w 0)) (Given reach 0))).
Definition below_zero :=
  Add (Given h 0) near_zero.
Definition above_zero :=
  Sub (Given h 0) near_zero.
Definition of_height :=
  Times (4236247 # 4194304) (Mul (Add (Const (3 # 8388608)) (Mul (Add (Const (1 # 1)) (Times (2 # 1) (Mul (Given
    error_w 0) (Given inverse 0)))) (Mul (Given error_w 0) (Given inverse 0)))) (Given inverse 0)).
Definition low_height :=
  Sub (Given inverse 0) of_height.
Definition high_height :=
  Add (Given inverse 0) of_height.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation computed := computes32.
Local Notation few := (/ 1180591620717411303424).  (* 2^-70 *)

(* The kernel's text: the constants of its slacks. *)
Definition slack_of (i c : Q) := Times i (Add (Given quotient_2 0) (Times c (Abs (Given quotient_1 0)))).
Definition by_w := Mul (Add (Const (1 # 1)) (Times (2 # 1) (Mul (Given error_w 0) (Given nearest 0)))) (Given nearest
  0).
Definition in_front_of (i c : Q) :=
  Times i (Add (Mul (Add (Given error 0) (Mul (Given error_w 0) (Given size 0))) by_w) (Times c (Given size 0))).
(* The product as it is computed, an input of the sides. *)
Definition computed_product := 90%nat.
Definition low_in_front_of value slack := Sub (Sub value slack) (Given point_error 0).
Definition high_in_front_of value slack := Add (Add slack value) (Given point_error 0).
Definition parallel_of (i c : Q) := Times i (Add (Given error 0) (Times c (Abs (Given h 0)))).
Definition near_zero_of (i : Q) :=
  Times i (Add (Given error 0) (Mul (Add (Abs (Given w 0)) (Given error_w 0)) (Given reach 0))).
Definition of_height_of (i c : Q) :=
  Times i (Mul (Add (Const c) (Mul (Add (Const (1 # 1)) (Times (2 # 1) (Mul (Given error_w 0) (Given inverse 0))))
    (Mul (Given error_w 0)
    (Given inverse 0)))) (Given inverse 0)).
Definition inflation : Q := match slack with Times i _ => i | _ => 0%Q end.
Definition of_size : Q := match slack with Times _ (Add _ (Times c _)) => c | _ => 0%Q end.
Definition of_inverse : Q := match of_height with Times _ (Mul (Add (Const c) _) _) => c | _ => 0%Q end.
Lemma kernels_are :
  slack = slack_of inflation of_size /\ in_front = in_front_of inflation of_size /\ of_height = of_height_of inflation
    of_inverse /\
  low = Sub (Sub (Given quotient_1 0) slack) (Given point_error 0) /\
  high = Add (Add (Given quotient_1 0) slack) (Given point_error 0) /\
  low_in_front = low_in_front_of product in_front /\ high_in_front = high_in_front_of product in_front /\
  low_parallel = Sub (Sub (Given h 0) (parallel_of inflation of_size)) (Given point_error 0) /\
  high_parallel = Add (Add (Given h 0) (parallel_of inflation of_size)) (Given point_error 0) /\
  below_zero = Add (Given h 0) (near_zero_of inflation) /\ above_zero = Sub (Given h 0) (near_zero_of inflation) /\
  low_height = Sub (Given inverse 0) of_height /\ high_height = Add (Given inverse 0) of_height.
Proof. repeat split. Qed.

Definition least_inflation : Q := 10099 # 10000.
Definition least_size : Q := 796 # 1677721600.    (* of a product; of a quotient 6.97 u, under a direction 2 u *)
Definition least_inverse : Q := 598 # 1677721600.

(* What is subtracted, and then a point's error, with a rounding each. *)
Lemma moved_down q s p v1 v P V e : 0 <= s -> 0 <= e -> (1 + 2 * u) * e <= p ->
  Rabs (v1 - (q - s)) <= u * Rabs (q - s) + 4 * h32 -> Rabs (v - (v1 - p)) <= u * Rabs (v1 - p) + 4 * h32 ->
  Rabs (q - V) <= P -> P + 201 / 100 * u * (Rabs q + s) + few <= s -> v <= V - e.
Proof.
  intros s0 e0 Hp H1 H2 HV HP. assert (q0 := Rabs_pos q). assert (b := between _ _ (Rle_refl (Rabs q))).
  assert (l := h32_below). simpl in l.
  assert (T1 : Rabs (q - s) <= Rabs q + s) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ H1) in T1. apply between in T1.
  assert (T2 : Rabs (v1 - p) <= (1 + u) * (Rabs q + s) + p + 4 * h32) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ H2) in T2. apply between in T2, HV. lra.
Qed.
Lemma moved_up q s p v1 v P V e : 0 <= s -> 0 <= e -> (1 + 2 * u) * e <= p ->
  Rabs (v1 - (q + s)) <= u * Rabs (q + s) + 4 * h32 -> Rabs (v - (v1 + p)) <= u * Rabs (v1 + p) + 4 * h32 ->
  Rabs (q - V) <= P -> P + 201 / 100 * u * (Rabs q + s) + few <= s -> V + e <= v.
Proof.
  intros s0 e0 Hp H1 H2 HV HP. assert (q0 := Rabs_pos q). assert (b := between _ _ (Rle_refl (Rabs q))).
  assert (l := h32_below). simpl in l.
  assert (T1 : Rabs (q + s) <= Rabs q + s) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ H1) in T1. apply between in T1.
  assert (T2 : Rabs (v1 + p) <= (1 + u) * (Rabs q + s) + p + 4 * h32) by (apply Rabs_le; lra).
  apply (at_most32 _ _ _ _ H2) in T2. apply between in T2, HV. lra.
Qed.

(* A quotient of numbers that are off by e and f. *)
Lemma quotient_moves n d N D e f : Rabs (n - N) <= e -> Rabs (d - D) <= f -> f < Rabs d ->
  Rabs (n / d - N / D) <= e * / (Rabs d - f) + Rabs (n / d) * (f * / (Rabs d - f)).
Proof.
  intros Hn Hd F. assert (f0 := Rle_trans _ _ _ (Rabs_pos _) Hd).
  assert (T := Rabs_triang_inv d (d - D)). replace (d - (d - D)) with D in T by ring.
  assert (D1 : 0 < Rabs d - f <= Rabs D) by lra.
  assert (D0 : D <> 0) by (intros Z; rewrite Z, Rabs_R0 in D1; lra).
  assert (d0 : d <> 0) by (intros Z; rewrite Z, Rabs_R0 in F; lra).
  replace (n / d - N / D) with ((n - N) * / D + - (n / d * ((d - D) * / D))) by (field; auto).
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, (Rabs_mult (n / d)), !(Rabs_mult _ (/ D)), Rabs_inv.
  assert (I : / Rabs D <= / (Rabs d - f)) by (apply Rinv_le_contravar; lra).
  assert (I0 : 0 <= / Rabs D) by (left; apply Rinv_0_lt_compat; lra).
  assert (G1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) I0 Hn I). assert (G2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) I0
    Hd I).
  assert (G3 := Rmult_le_compat_l _ _ _ (Rabs_pos (n / d)) G2). lra.
Qed.

Section Vertex.
Variable x : nat -> R.
Variables H W E : R.  (* the real coordinate, before the division, and W; a point's real error *)
Let e := x error. Let f := x error_w. Let p := x point_error.
Hypotheses (h_near : Rabs (x h - H) <= e) (w_near : Rabs (x w - W) <= f).
Hypotheses (E0 : 0 <= E) (E_below : (1 + 2 * u) * E <= p).
Variables i c : Q.
Hypotheses (i_in : Q2R least_inflation <= Q2R i) (c_in : Q2R least_size <= Q2R c) (i_less : Q2R i <= 2) (c_less : Q2R c <= 1).
Lemma i_is : 10099 / 10000 <= Q2R i.
Proof. revert i_in. unfold Q2R at 1, least_inflation. simpl. lra. Qed.
Lemma c_is : 796 / 100 * u <= Q2R c.
Proof. revert c_in. unfold Q2R at 1, least_size. simpl. lra. Qed.
Lemma e0 : 0 <= e. Proof. exact (Rle_trans _ _ _ (Rabs_pos _) h_near). Qed.
Lemma f0 : 0 <= f. Proof. exact (Rle_trans _ _ _ (Rabs_pos _) w_near). Qed.
(* A sum a + c b, times i. *)
Lemma times_both a b : 0 <= a -> 0 <= b -> 10099 / 10000 * (a + 796 / 100 * u * b) <= Q2R i * (a + Q2R c * b).
Proof.
  intros a0 b0. assert (I := i_is). assert (C := c_is). assert (G := Rmult_le_compat_r b _ _ b0 C).
  apply Rmult_le_compat; lra.
Qed.
Lemma near_from_below ex v P k l : computed x ex v -> real x ex = P -> permanent x ex = P -> roundings ex = k ->
  (k <= 16)%nat -> lost32 x ex <= l -> (1 - INR k * (1 + / 1048576) * u) * P - l <= v.
Proof.
  intros C R1 R2 K k16 L. apply near32 in C. rewrite R1, R2, K in C. assert (A := alpha_below k k16).
  assert (P0 : 0 <= P) by (rewrite <- R2; apply permanent_positive).
  assert (G := Rmult_le_compat_r P _ _ P0 A). apply between in C. lra.
Qed.
Lemma h_is : 0 < h32 <= / 2 ^ 126 /\ 0 <= h32 * h32 <= / 2 ^ 126 * h32.
Proof. exact h32_powers. Qed.

(* ---- A quotient of its own ---- *)
Section Quotient.
Let q := x quotient_1.
Hypotheses (far : 2 * f < Rabs (x w)) (f_of_w : 9 * u * Rabs (x w) <= f) (e_least : / 2 ^ 90 <= e)
  (f_least : / 2 ^ 90 <= f <= 16777216 * e).
Hypothesis q_near : Rabs (q - x h / x w) <= 501 / 100 * u * Rabs (x h / x w) + h32.
Variables n d : R.
Hypotheses (Cn : computed x quotient_2_over n) (Cd : computed x quotient_2_under d).
Hypotheses (q2_near : Rabs (x quotient_2 - n / d) <= 501 / 100 * u * Rabs (n / d) + h32) (q2_positive : 0 <= x quotient_2).

Lemma slack_is_enough s : computed x (slack_of i c) s ->
  exists P, 0 <= s /\ Rabs (q - H / W) <= P /\ P + 201 / 100 * u * (Rabs q + s) + few <= s.
Proof.
  intros Cs. assert (e1 := e0). assert (f1 := f0). assert (q0 := Rabs_pos q). destruct h_is as [l ll]. simpl in l, ll.
  assert (f_is := f_least). assert (e_low := e_least). simpl in e_low. simpl in f_is.
  set (g := Rabs (x w) - f). assert (g0 : f < g) by (unfold g; lra). assert (I := Rinv_0_lt_compat g ltac:(lra)).
  set (J := / g) in *. assert (M := quotient_moves _ _ _ _ _ _ h_near w_near ltac:(lra)). fold g J in M.
  set (Q := x h / x w) in *. set (t := f * J) in *. assert (t0 : 0 <= t) by (unfold t; apply Rmult_le_pos; lra).
  assert (gJ : g * J = 1) by (unfold J; field; lra).
  assert (t1 : t <= 1) by (unfold t; rewrite <- gJ; apply Rmult_le_compat_r; lra).
  assert (hJ : h32 * J <= / 2 ^ 36 * (e * J)).
  { assert (K := Rmult_le_compat_r J h32 (/ 2 ^ 36 * e) ltac:(lra) ltac:(simpl; lra)). lra. }
  assert (hJ' : h32 * J <= / 2 ^ 36).
  { assert (K := Rmult_le_compat_r J (/ 2 ^ 90) g ltac:(lra) ltac:(simpl; lra)). rewrite gJ in K. simpl in K.
    assert (K2 := Rmult_le_compat_r J h32 _ ltac:(lra) (proj2 l)). simpl. lra. }
  simpl in hJ, hJ'. assert (eJ0 : / 2 ^ 46 <= e * J).
  { assert (K := Rmult_le_compat_r J (/ 2 ^ 46 * g) e ltac:(lra) ltac:(unfold g; simpl; lra)). rewrite Rmult_assoc, gJ in K.
    simpl in K. simpl. lra. }
  simpl in eJ0. assert (eJ : 0 <= e * J) by (apply Rmult_le_pos; lra).
  assert (T := Rabs_triang_inv Q (Q - q)). replace (Q - (Q - q)) with q in T by ring. rewrite (Rabs_minus_sym Q) in T.
  assert (Q1 : Rabs Q <= (1 + 502 / 100 * u) * Rabs q + 2 * h32) by lra. assert (Q0 := Rabs_pos Q).
  assert (Qt := Rmult_le_compat_r t _ _ t0 Q1). assert (qt : 0 <= Rabs q * t) by (now apply Rmult_le_pos).
  assert (qt1 : Rabs q * t <= Rabs q) by (assert (K := Rmult_le_compat_l _ _ _ q0 t1); lra).
  assert (ht : h32 * t <= h32) by (assert (K := Rmult_le_compat_l h32 _ _ ltac:(lra) t1); lra).
  (* The computed quotient of the errors. *)
  set (lost_n := h32 * (3 * Rabs q + 3 * f + 12)).
  assert (Nn := near_from_below _ _ (e + Rabs q * f) 2 lost_n Cn eq_refl ltac:(cbn; fold e f q; rewrite (Rabs_pos_eq e),
    (Rabs_pos_eq f) by lra; reflexivity) eq_refl ltac:(lia)).
  specialize (Nn ltac:(unfold lost32, lost_n; cbn -[u32 h32]; unfold of_product, alpha; simpl pow; rewrite !u32_value;
    fold e f q; rewrite !(Rabs_pos_eq f) by lra; assert (0 <= h32 * Rabs q) by (apply Rmult_le_pos; lra);
    assert (0 <= h32 * f) by (apply Rmult_le_pos; lra); lra)).
  simpl INR in Nn. destruct (step32_sub _ _ _ _ Cd) as (a & b & Ca & Cb & S). apply given32_is in Cb. subst b.
  assert (a_is : Rabs (a - Rabs (x w)) <= h32).
  { clear - Ca l. inversion Ca as [ | | | | | ? r z D G | | | | ]; subst. apply given32_is in D. subst. apply seen32_near in G.
    eapply Rle_trans; [apply Rabs_triang_inv2 | exact G]. }
  fold f in S. assert (gh : 10 * h32 <= / 100 * u * g) by lra. apply between in a_is.
  assert (S' : Rabs (a - f) <= g + h32) by (unfold g in *; apply Rabs_le; lra). apply (at_most32 _ _ _ _ S) in S'.
  apply between in S'. assert (d_in : (1 - 102 / 100 * u) * g <= d <= (1 + 102 / 100 * u) * g) by (unfold g in *; lra).
  assert (d1 : 0 < d) by lra. assert (ef : 0 <= e + Rabs q * f) by (assert (0 <= Rabs q * f) by (now apply
    Rmult_le_pos; lra); lra).
  assert (D1 : (1 - 2 * u) * J <= / d <= (1 + 2 * u) * J).
  { split; apply Rmult_le_reg_r with d; try lra; rewrite Rinv_l by lra.
    - assert (K := Rmult_le_compat_l J d _ ltac:(lra) (proj2 d_in)).
      replace (J * ((1 + 102 / 100 * u) * g)) with ((1 + 102 / 100 * u) * (g * J)) in K by ring. rewrite gJ in K. lra.
    - assert (K := Rmult_le_compat_l J _ d ltac:(lra) (proj1 d_in)).
      replace (J * ((1 - 102 / 100 * u) * g)) with ((1 - 102 / 100 * u) * (g * J)) in K by ring. rewrite gJ in K. lra. }
  set (A := (1 - 41 / 10 * u) * (e * J + Rabs q * t) - / 500 * u * Rabs q - / 1000 * (e * J)).
  assert (N : A <= n / d).
  { assert (K := Rmult_le_compat ((1 - 21 / 10 * u) * (e + Rabs q * f)) (n + lost_n) ((1 - 2 * u) * J) (/ d) ltac:(apply
      Rmult_le_pos; lra) ltac:(apply Rmult_le_pos; lra) ltac:(lra) (proj1 D1)).
    assert (L0 : 0 <= lost_n) by (unfold lost_n; apply Rmult_le_pos; lra).
    assert (K2 := Rmult_le_compat_l lost_n _ _ L0 (proj2 D1)).
    assert (K3 : lost_n * J <= 3 * / 2 ^ 36 * Rabs q + 13 * / 2 ^ 36 * (e * J)).
    { unfold lost_n. replace (h32 * (3 * Rabs q + 3 * f + 12) * J) with (3 * (h32 * J) * Rabs q + 3 * (h32 * t) + 12 * (h32 * J))
        by (unfold t; ring). assert (K4 := Rmult_le_compat_r (Rabs q) _ _ q0 hJ'). simpl. lra. }
    simpl in K3. assert (qt2 : Rabs q * t = Rabs q * f * J) by (unfold t; ring). unfold A, Rdiv. simpl. lra. }
  assert (q2 : (1 - 51 / 10 * u) * A - h32 <= x quotient_2).
  { destruct (Rle_dec 0 (n / d)) as [nd | nd].
    - rewrite (Rabs_pos_eq (n / d)) in q2_near by exact nd. apply between in q2_near. lra.
    - lra. }
  assert (c1 := c_is). assert (i1 := i_is).
  assert (Ns := near_from_below _ _ (Q2R i * (x quotient_2 + Q2R c * Rabs q)) 3 (40 * h32) Cs eq_refl ltac:(cbn -[Q2R]; fold q;
    rewrite (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq (Q2R c)), (Rabs_pos_eq (x quotient_2)) by lra; reflexivity) eq_refl
    ltac:(lia)).
  specialize (Ns ltac:(unfold lost32; cbn -[u32 h32 Q2R]; rewrite (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq (Q2R c)), !u32_value by lra;
    assert (ch := Rmult_le_compat_r (h32 + h32) _ _ ltac:(lra) c_less);
    match goal with |- _ * (Q2R i * ?y) + _ <= _ => assert (0 <= y) by (repeat first [lra | apply
      Rplus_le_le_0_compat | apply Rmult_le_pos]); assert (ih := Rmult_le_compat_r y _ _ ltac:(assumption) i_less) end; lra)).
  simpl INR in Ns. assert (B := times_both _ _ q2_positive q0). unfold A in *. simpl in q2, N.
  exists (501 / 100 * u * Rabs Q + h32 + (e * J + Rabs Q * t)). repeat split.
  - apply (positive_is x (slack_of i c)); [cbn -[Q2R]; repeat split; lra | exact Cs].
  - assert (T2 := Rabs_triang (q - Q) (Q - H / W)). replace (q - Q + (Q - H / W)) with (q - H / W) in T2 by ring. lra.
  - lra.
Qed.

Theorem low_side_is_below v : computed x (Sub (Sub (Given quotient_1 0) (slack_of i c)) (Given point_error 0)) v -> v
  <= H /
  W - E.
Proof.
  intros C. destruct (step32_sub _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given32_is in C2. subst p1.
  destruct (step32_sub _ _ _ _ C1) as (q1 & s & C3 & C4 & R1). apply given32_is in C3. subst q1.
  destruct (slack_is_enough s C4) as (P & s0 & A & B). eapply moved_down; eassumption.
Qed.
Theorem high_side_is_above v : computed x (Add (Add (Given quotient_1 0) (slack_of i c)) (Given point_error 0)) v ->
  H / W
  + E <= v.
Proof.
  intros C. destruct (step32_add _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given32_is in C2. subst p1.
  destruct (step32_add _ _ _ _ C1) as (q1 & s & C3 & C4 & R1). apply given32_is in C3. subst q1.
  destruct (slack_is_enough s C4) as (P & s0 & A & B). eapply moved_up; eassumption.
Qed.
End Quotient.

(* ---- A product with the reciprocal ---- *)
Section Inverse.
Let z := x inverse.
Hypotheses (front : 2 * f < x w) (w_in : x w <= 2 ^ 40) (f_of_w : 9 * u * x w <= f)
  (e_least : / 2 ^ 90 <= e) (f_least : / 2 ^ 90 <= f <= 16777216 * e).
Hypothesis z_is : Rabs (z - / x w) <= 501 / 100 * u * / x w + h32.
Let t := f * / x w.
Lemma w_sizes : 0 < x w /\ / 2 ^ 40 <= / x w <= 2 ^ 89.
Proof.
  assert (f1 := f0). simpl in f_least, w_in. assert (w0 : 0 < x w) by lra. split; [exact w0 |]. split.
  - apply Rinv_le_contravar; simpl; lra.
  - replace (2 ^ 89) with (/ / 2 ^ 89) by (field; simpl; lra). apply Rinv_le_contravar; simpl; lra.
Qed.
Lemma z_near : Rabs (z - / x w) <= 5011 / 1000 * u * / x w.
Proof. destruct w_sizes as (_ & I & _). assert (l := h32_below). simpl in l, I. lra. Qed.
Lemma t_in : 0 <= t /\ 2 * t <= 1.
Proof.
  assert (f1 := f0). assert (w0 : 0 < x w) by lra. assert (I := Rinv_0_lt_compat _ w0). unfold t. split.
  - apply Rmult_le_pos; lra.
  - replace 1 with (x w * / x w) by (field; lra). rewrite <- Rmult_assoc. apply Rmult_le_compat_r; lra.
Qed.
Lemma inverse_of_difference : / (x w - f) <= / x w * (1 + 2 * t).
Proof.
  assert (f1 := f0). destruct t_in as [t0 t1]. assert (w0 : 0 < x w) by lra.
  apply Rmult_le_reg_r with (x w - f); [lra |]. rewrite Rinv_l by lra.
  replace (/ x w * (1 + 2 * t) * (x w - f)) with (1 + t * (1 - 2 * t)) by (unfold t; field; lra).
  assert (0 <= t * (1 - 2 * t)) by (apply Rmult_le_pos; lra). lra.
Qed.
Lemma z_in : 0 < z /\ (1 - 5011 / 1000 * u) * / x w <= z /\ / x w <= (1 + 502 / 100 * u) * z.
Proof.
  assert (f1 := f0). assert (w0 : 0 < x w) by lra. assert (I := Rinv_0_lt_compat _ w0).
  assert (B := between _ _ z_near). repeat split; lra.
Qed.

(* y is the product as it is computed: one float in the sides and in `size`, the greatest of a hull's products. *)
Let y := x computed_product.
Hypotheses (y_is : computed x product y) (size_positive : 0 <= x size) (size_is : Rabs y <= x size + h32).
Hypothesis nearest_is : z <= x nearest.
(* `nearest` belongs to a vertex that is as certainly in front. *)
Hypotheses (nearest_in : x nearest <= 2 ^ 90) (nearest_front : f * x nearest <= 51 / 100).
Lemma in_front_is_enough s : computed x (in_front_of i c) s ->
  exists P, 0 <= s /\ Rabs (y - H / W) <= P /\ P + 201 / 100 * u * (Rabs y + s) + few <= s.
Proof.
  intros Cs. assert (Cy := y_is). assert (y_in := size_is). assert (e1 := e0). assert (f1 := f0). destruct w_sizes as (w0 & w1 & w2).
  simpl in w1, w2. destruct h_is as [l ll]. simpl in l, ll. assert (f_is := f_least). assert (e_low := e_least). simpl in e_low. assert (m1 := nearest_in). simpl in f_is, m1.
  assert (I := Rinv_0_lt_compat _ w0). destruct t_in as [t0 t1]. destruct z_in as (z0 & z1 & z2). assert (y0 :=
    Rabs_pos y). assert (z_b := z_near).
  assert (M := quotient_moves _ _ _ _ _ _ h_near w_near ltac:(rewrite (Rabs_pos_eq (x w)); lra)).
  rewrite (Rabs_pos_eq (x w)) in M by lra.
  set (J := / (x w - f)) in *. assert (J0 : 0 < J) by (apply Rinv_0_lt_compat; lra). set (Q := x h / x w) in *.
  set (r := f * J) in *. assert (r0 : 0 <= r) by (unfold r; apply Rmult_le_pos; lra).
  assert (r1 : r <= 1).
  { unfold r. replace 1 with ((x w - f) * J) by (unfold J; field; lra). apply Rmult_le_compat_r; lra. }
  assert (wJ : / x w <= J) by (unfold J; apply Rinv_le_contravar; lra).
  assert (eJ0 : / 2 ^ 46 <= e * J).
  { assert (K := Rmult_le_compat_l e (/ x w) J e1 wJ).
    assert (K2 := Rmult_le_compat_r (/ x w) (/ 2 ^ 46 * x w) e ltac:(lra) ltac:(assert (f_w := f_of_w); simpl; lra)).
    rewrite Rmult_assoc, Rinv_r in K2 by lra. simpl in K2. simpl. lra. }
  simpl in eJ0.
  (* The product. *)
  destruct (step32_mul _ _ _ _ Cy) as (h1 & i1 & C1 & C2 & Y). apply given32_is in C1, C2. subst h1 i1. fold z in Y.
  assert (Y2 : Rabs (x h * z - Q) <= 5011 / 1000 * u * Rabs Q).
  { unfold Q, Rdiv. rewrite <- Rmult_minus_distr_l, !Rabs_mult, (Rabs_pos_eq (/ x w)) by lra.
    assert (K := Rmult_le_compat_l _ _ _ (Rabs_pos (x h)) z_b). lra. }
  assert (T := Rabs_triang (x h * z - Q) Q). replace (x h * z - Q + Q) with (x h * z) in T by ring.
  assert (Q0 := Rabs_pos Q).
  assert (Yl : 2 * h32 * (Rabs (x h) + Rabs z + 1) <= / 1000 * u * Rabs Q + / 1000 * (e * J)).
  { assert (K : Rabs (x h) <= 2 ^ 40 * Rabs Q).
    { unfold Q, Rdiv. rewrite Rabs_mult, (Rabs_pos_eq (/ x w)) by lra.
      assert (K := Rmult_le_compat_l (2 ^ 40 * Rabs (x h)) (/ 2 ^ 40) _ ltac:(apply Rmult_le_pos; [simpl; lra | apply Rabs_pos])
        ltac:(simpl; exact w1)). simpl in K. simpl. lra. }
    assert (zh : h32 * z <= / 2 ^ 34 * (e * J)).
    { assert (z_bb := between _ _ z_b). assert (K2 := Rmult_le_compat h32 (/ 2 ^ 36 * e) z (2 * J) ltac:(lra) ltac:(lra) ltac:(simpl; lra)
        ltac:(lra)). simpl in K2. simpl. lra. }
    assert (K3 := Rmult_le_compat h32 (/ 2 ^ 126) _ _ ltac:(lra) (Rabs_pos (x h)) ltac:(simpl; lra) K).
    simpl in K3, zh. rewrite (Rabs_pos_eq z) by lra. lra. }
  assert (Y3 : Rabs (y - Q) <= 602 / 100 * u * Rabs Q + / 1000 * (e * J)).
  { assert (T2 := Rabs_triang (y - x h * z) (x h * z - Q)). replace (y - x h * z + (x h * z - Q)) with (y - Q) in T2
    by ring.
    lra. }
  assert (T3 := Rabs_triang_inv Q (Q - y)). replace (Q - (Q - y)) with y in T3 by ring. rewrite (Rabs_minus_sym Q) in
    T3.
  set (S := x size) in *. assert (S0 : 0 <= S) by exact size_positive.
  assert (Q1 : Rabs Q <= (1 + 603 / 100 * u) * S + / 990 * (e * J)) by lra.
  assert (Qr := Rmult_le_compat_r r _ _ r0 Q1). assert (eJr := Rmult_le_compat_l (e * J) _ _ ltac:(lra) r1). assert (Sr : 0 <= S * r) by (now apply Rmult_le_pos).
  assert (Sr1 : S * r <= S) by (assert (K := Rmult_le_compat_l _ _ _ S0 r1); lra).
  assert (eJ : 0 <= e * J) by (apply Rmult_le_pos; lra).
  (* The reciprocal's bound. *)
  set (m := x nearest) in *. assert (m0 : 0 < m) by lra. set (B := (1 + 2 * (f * m)) * m).
  assert (fm : (1 - 5011 / 1000 * u) * t <= f * m).
  { unfold t. assert (K := Rmult_le_compat_l f _ _ f1 (Rle_trans _ _ _ z1 nearest_is)). lra. }
  assert (B1 : (1 - 101 / 10 * u) * J <= B).
  { assert (K := inverse_of_difference). fold J in K. unfold B.
    assert (K2 := Rmult_le_compat (1 + 2 * ((1 - 5011 / 1000 * u) * t)) _ ((1 - 5011 / 1000 * u) * / x w) m ltac:(lra)
      ltac:(apply Rmult_le_pos; lra) (Rplus_le_compat_l 1 _ _ (Rmult_le_compat_l 2 _ _ ltac:(lra) fm)) ltac:(lra)).
    assert (K3 : (1 - 5011 / 1000 * u) * (1 + 2 * t) <= 1 + 2 * ((1 - 5011 / 1000 * u) * t)) by lra.
    assert (K4 := Rmult_le_compat_r ((1 - 5011 / 1000 * u) * / x w) _ _ ltac:(apply Rmult_le_pos; lra) K3).
    assert (K5 := Rmult_le_compat_l (1 - 101 / 10 * u) _ _ ltac:(lra) K).
    assert (K6 : 0 <= / x w * (1 + 2 * t)) by (apply Rmult_le_pos; lra). lra. }
  assert (eS : 0 <= e + f * S) by (assert (0 <= f * S) by (now apply Rmult_le_pos; lra); lra).
  assert (A := Rmult_le_compat_l _ _ _ eS B1). assert (B0 : 0 <= B) by (eapply Rle_trans; [| exact B1]; apply
    Rmult_le_pos; lra).
  assert (c1 := c_is). assert (i2 := i_is).
  (* What is computed of both factors, and of the whole. *)
  assert (m_least : / 2 ^ 41 <= m) by (simpl; lra). simpl in m_least.
  assert (hm : h32 * m <= / 2 ^ 36).
  { assert (K := Rmult_le_compat h32 (/ 2 ^ 126) m (2 ^ 90) ltac:(lra) ltac:(lra) ltac:(simpl; lra) ltac:(simpl; lra)).
    simpl in K. simpl. lra. }
  simpl in hm. assert (hm0 : 0 <= h32 * m) by (apply Rmult_le_pos; lra).
  assert (hmm := Rmult_le_compat_r m _ _ ltac:(lra) hm). assert (f_m : 0 <= f * m) by (apply Rmult_le_pos; lra).
  assert (front_m := nearest_front). fold m in front_m. assert (fmm := Rmult_le_compat_r m _ _ ltac:(lra) f_m).
  assert (hfm := Rmult_le_compat_l h32 _ _ ltac:(lra) front_m). assert (hf0 : 0 <= h32 * f) by (apply Rmult_le_pos; lra).
  assert (hm2 := Rmult_le_compat_r m _ _ ltac:(lra) (proj2 l)).
  assert (hf1 : h32 * f <= / 1000).
  { assert (K := Rmult_le_compat h32 (/ 2 ^ 126) f (2 ^ 40) ltac:(lra) f1 ltac:(simpl; lra) ltac:(assert (w_in2 := w_in); simpl in w_in2 |- *; lra)).
    simpl in K. lra. }
  assert (hhm := Rmult_le_compat_r m _ _ ltac:(lra) (proj2 ll)). assert (hhm0 := Rmult_le_pos _ m (proj1 ll) ltac:(lra)).
  assert (hhf := Rmult_le_compat_l h32 _ _ ltac:(lra) hf1). assert (hhf0 := Rmult_le_pos _ f (proj1 ll) ltac:(lra)).
  assert (hhh := Rmult_le_compat_r h32 _ _ ltac:(lra) (proj2 ll)). assert (hhh0 := Rmult_le_pos _ h32 (proj1 ll) ltac:(lra)).
  assert (least_sum : forall p, computed x (Add (Given error 0) (Mul (Given error_w 0) (Given size 0))) p ->
    (1 - 22 / 10 * u) * (e + f * S) <= p).
  { intros p' Cp. assert (fS : 0 <= f * S) by (apply Rmult_le_pos; lra).
    assert (N := near_from_below _ _ (e + f * S) 2 (h32 * (3 * S + 3 * f + 12)) Cp eq_refl ltac:(cbn; fold e f S;
      rewrite (Rabs_pos_eq e), (Rabs_pos_eq f), (Rabs_pos_eq S) by lra; reflexivity) eq_refl ltac:(lia)).
    assert (hS := Rmult_le_pos h32 S ltac:(lra) S0).
    specialize (N ltac:(unfold lost32; cbn -[u32 h32]; unfold of_product, alpha; simpl pow; rewrite !u32_value;
      fold e f S; rewrite (Rabs_pos_eq f), (Rabs_pos_eq S) by lra; lra)). simpl INR in N.
    assert (hfS := Rmult_le_compat_r S h32 (/ 1000 * u * f) S0 ltac:(lra)).
    assert (hf := Rmult_le_compat_l h32 _ _ ltac:(lra) (proj2 f_is)). assert (he := Rmult_le_compat_r e _ _ e1 (proj2 l)). lra. }
  assert (least_by_w : forall p, computed x by_w p -> (1 - 52 / 10 * u) * B <= p).
  { intros p' Cp. unfold by_w in Cp.
    assert (N := near_from_below _ _ B 4 (h32 * (3 + 10 * (f * m) + 30 * m + 10 * (m * m))) Cp ltac:(cbn -[Q2R]; unfold B;
      rewrite Q2R_1, Q2R_2; reflexivity) ltac:(cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold f m;
      rewrite (Rabs_pos_eq f), (Rabs_pos_eq m), (Rabs_pos_eq 1), (Rabs_pos_eq 2) by lra; reflexivity) eq_refl ltac:(lia)).
    specialize (N ltac:(unfold lost32; cbn -[u32 h32 Q2R]; rewrite ?Q2R_1, ?Q2R_2; unfold of_product, alpha; simpl pow;
      rewrite !u32_value; fold f m; rewrite ?(Rabs_pos_eq f), ?(Rabs_pos_eq m), ?(Rabs_pos_eq 1), ?(Rabs_pos_eq 2) by lra;
      assert (hf_m := Rmult_le_pos h32 (f * m) ltac:(lra) f_m); assert (h_m_m := Rmult_le_pos (h32 * m) m hm0 ltac:(lra));
      lra)). simpl INR in N. unfold B in *. lra. }
  set (N1 := (1 - 22 / 10 * u) * (e + f * S)) in *. set (N2 := (1 - 52 / 10 * u) * B) in *.
  assert (N10 : 0 <= N1) by (unfold N1; apply Rmult_le_pos; lra). assert (N20 : 0 <= N2) by (unfold N2; apply Rmult_le_pos; lra).
  assert (c10 : 0 <= Q2R c) by lra. assert (cS : 0 <= Q2R c * S) by (apply Rmult_le_pos; lra).
  assert (B_least : / 2 ^ 42 <= B) by (unfold B; simpl; lra). simpl in B_least.
  assert (eB := Rmult_le_compat_r B _ _ B0 (proj1 f_is)). assert (e_is : / 2 ^ 94 <= e) by (simpl; lra). simpl in e_is.
  set (N3 := (1 - 86 / 10 * u) * ((e + f * S) * B)).
  assert (hN3 : forall p, computed x (Mul (Add (Given error 0) (Mul (Given error_w 0) (Given size 0))) by_w) p ->
    Rmax 0 (N3 - 2 * h32) <= p).
  { intros p' Cp. apply Rmax_lub.
    { apply (positive_is x _ _) in Cp; [exact Cp | cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold e f S m; repeat split; lra]. }
    assert (N := least_mul x _ _ N1 N2 _ Cp N10 N20 least_sum least_by_w).
    assert (K1 := Rmult_le_compat_l (h32 * (e + f * S)) _ _ ltac:(apply Rmult_le_pos; lra) B_least).
    assert (K2 := Rmult_le_compat_r B (/ 2 ^ 94) (e + f * S) B0 ltac:(simpl; assert (0 <= f * S) by (apply Rmult_le_pos; lra); lra)).
    simpl in K2. assert (K3 := Rmult_le_compat_r B _ _ B0 (proj2 l)).
    assert (K4 := Rmult_le_compat_r (e + f * S) _ _ eS (proj2 l)).
    assert (K5 := Rmult_le_compat_l (e + f * S) _ _ eS B_least). unfold N1, N2, N3 in *. lra. }
  assert (hN4 : forall p, computed x (Times c (Given size 0)) p -> (1 - 11 / 10 * u) * (Q2R c * S) - 3 * h32 <= p).
  { intros p' Cp. assert (N := least_times x c _ S _ Cp c10 S0 ltac:(intros p'' C'; apply least_given in C'; exact C')).
    assert (ch := Rmult_le_compat_r h32 _ _ ltac:(lra) c_less). lra. }
  assert (s_is : (1 - 9 / 1000000) * (Q2R i * 0) <= s) by (replace (Q2R i * 0) with 0 by ring; rewrite Rmult_0_r;
    apply (positive_is x (in_front_of i c)); [cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold e f S m; repeat split; lra | exact Cs]).
  assert (Ns : (1 - 108 / 10 * u) * (Q2R i * ((e + f * S) * B + Q2R c * S)) - 100 * h32 <= s).
  { unfold in_front_of in Cs. set (N5 := (1 - 97 / 10 * u) * ((e + f * S) * B + Q2R c * S)).
    assert (N50 : 0 <= (e + f * S) * B) by (now apply Rmult_le_pos).
    assert (K : forall p, computed x (Add (Mul (Add (Given error 0) (Mul (Given error_w 0) (Given size 0))) by_w)
      (Times c (Given size 0))) p -> N5 - 20 * h32 <= p).
    { intros p' Cp. assert (Z : forall q, computed x (Times c (Given size 0)) q -> Rmax 0 ((1 - 11 / 10 * u) * (Q2R c * S) - 3 * h32) <= q).
      { intros q0 Cq. apply Rmax_lub; [| now apply hN4].
        apply (positive_is x (Times c (Given size 0))); [cbn -[Q2R]; fold S; repeat split; lra | exact Cq]. }
      assert (N := least_add x _ _ _ _ _ Cp (Rmax_l _ _) (Rmax_l _ _) hN3 Z).
      assert (X3 := Rmax_r 0 (N3 - 2 * h32)). assert (X := Rmax_r 0 ((1 - 11 / 10 * u) * (Q2R c * S) - 3 * h32)). unfold N3, N5 in *. lra. }
    assert (K0 : forall p, computed x (Add (Mul (Add (Given error 0) (Mul (Given error_w 0) (Given size 0))) by_w)
      (Times c (Given size 0))) p -> Rmax 0 (N5 - 20 * h32) <= p).
    { intros p' Cp. apply Rmax_lub; [| now apply K].
      apply (positive_is x _ _) in Cp; [exact Cp | cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold e f S m; repeat split; lra]. }
    assert (N := least_times x i _ _ s Cs ltac:(lra) (Rmax_l _ _) K0).
    assert (X := Rmax_r 0 (N5 - 20 * h32)). assert (X2 := Rmult_le_compat_l (Q2R i) _ _ ltac:(lra) X).
    assert (ih := Rmult_le_compat_r h32 _ _ ltac:(lra) i_less). unfold N5 in *.
    assert (N6 : 0 <= Q2R i * ((e + f * S) * B + Q2R c * S)) by (apply Rmult_le_pos; lra). lra. }
  assert (D := times_both ((e + f * S) * B) S ltac:(apply Rmult_le_pos; lra) S0).
  replace ((e + f * S) * ((1 - 101 / 10 * u) * J)) with ((1 - 101 / 10 * u) * (e * J + S * r)) in A by (unfold r;
    ring).
  exists (602 / 100 * u * Rabs Q + / 1000 * (e * J) + (e * J + Rabs Q * r)). repeat split.
  - lra.
  - assert (T2 := Rabs_triang (y - Q) (Q - H / W)). replace (y - Q + (Q - H / W)) with (y - H / W) in T2 by ring. lra.
  - lra.
Qed.
Theorem low_side_in_front v :
  computed x (low_in_front_of (Given computed_product 0) (in_front_of i c)) v -> v <= H / W - E.
Proof.
  intros C. destruct (step32_sub _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given32_is in C2. subst p1.
  destruct (step32_sub _ _ _ _ C1) as (y1 & s & C3 & C4 & R1). apply given32_is in C3. subst y1.
  destruct (in_front_is_enough s C4) as (P & s0 & A & B). eapply moved_down; eassumption.
Qed.
Theorem high_side_in_front v :
  computed x (high_in_front_of (Given computed_product 0) (in_front_of i c)) v -> H / W + E <= v.
Proof.
  intros C. destruct (step32_add _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given32_is in C2. subst p1.
  destruct (step32_add _ _ _ _ C1) as (s & y1 & C4 & C3 & R1). apply given32_is in C3. subst y1. rewrite (Rplus_comm s) in R1.
  destruct (in_front_is_enough s C4) as (P & s0 & A & B). eapply moved_up; eassumption.
Qed.

(* ---- Heights ---- *)
Variable k : Q.
Hypotheses (k_in : Q2R least_inverse <= Q2R k) (k_most : Q2R k <= 2).
Lemma of_height_is_enough s : computed x (of_height_of i k) s ->
  10090 / 10000 * (598 / 100 * u * z + f * z * (1 + 2 * (f * z)) * z) <= s /\
  / W <= z + (502 / 100 * u * z + (1 + 16 * u) * (f * z * (1 + 2 * (f * z)) * z)) /\
  z - (502 / 100 * u * z + (1 + 16 * u) * (f * z * (1 + 2 * (f * z)) * z)) <= / W.
Proof.
  intros Cs. assert (f1 := f0). destruct w_sizes as (w0 & w1 & w2). simpl in w1, w2. destruct h_is as [l ll]. simpl in l, ll.
  assert (I := Rinv_0_lt_compat _ w0). destruct t_in as [t0 t1]. destruct z_in as (z0 & z1 & z2). assert (i1 := i_is).
  assert (f_is := f_least). assert (e_low := e_least). simpl in e_low. assert (w_in2 := w_in). simpl in f_is, w_in2. assert (z_b := between _ _ z_near).
  assert (k1 : 598 / 100 * u <= Q2R k) by (revert k_in; unfold Q2R at 1, least_inverse; simpl; lra).
  set (r := f * z) in *. assert (r0 : 0 <= r) by (unfold r; apply Rmult_le_pos; lra).
  set (T := r * (1 + 2 * r)) in *. assert (T0 : 0 <= T) by (unfold T; apply Rmult_le_pos; lra).
  assert (rT : r <= T) by (unfold T; assert (0 <= r * r) by (now apply Rmult_le_pos); lra).
  assert (rz : 0 <= r * z) by (apply Rmult_le_pos; lra). assert (Tz := Rmult_le_compat_r z _ _ ltac:(lra) rT).
  split.
  - assert (r1 : r <= 51 / 100).
    { assert (K := Rmult_le_compat_l f z ((1 + 6 * u) * / x w) f1 ltac:(lra)). fold r in K. unfold t in t1. lra. }
    assert (hz : h32 * z <= / 2 ^ 36).
    { assert (K := Rmult_le_compat h32 (/ 2 ^ 126) z (2 ^ 90) ltac:(lra) ltac:(lra) ltac:(simpl; lra) ltac:(simpl; lra)).
      simpl in K. simpl. lra. }
    assert (hf : h32 * f <= / 2 ^ 80).
    { assert (K := Rmult_le_compat h32 (/ 2 ^ 126) f (2 ^ 40) ltac:(lra) ltac:(lra) ltac:(simpl; lra) ltac:(simpl; lra)).
      simpl in K. simpl. lra. }
    simpl in hz, hf. set (A1 := Rmax 0 ((1 - 11 / 10 * u) * r - / 2 ^ 35)).
    assert (A10 : 0 <= A1) by apply Rmax_l. assert (A11 : (1 - 11 / 10 * u) * r - / 2 ^ 35 <= A1) by apply Rmax_r.
    simpl in A11. assert (A12 : A1 <= 51 / 100) by (apply Rmax_lub; [lra | simpl; lra]).
    assert (L1 : forall v, computed x (Mul (Given error_w 0) (Given inverse 0)) v -> A1 <= v).
    { intros v C. apply Rmax_lub.
      - apply (positive_is x _ _) in C; [exact C | cbn; fold f z; repeat split; lra].
      - assert (N := least_mul x _ _ f z v C f1 ltac:(lra) ltac:(intros ? D; apply least_given in D; exact D)
          ltac:(intros ? D; apply least_given in D; exact D)). fold r in N. simpl. lra. }
    assert (L2 : forall v, computed x (Add (Const (1 # 1)) (Times (2 # 1) (Mul (Given error_w 0) (Given inverse 0)))) v ->
      (1 - 22 / 10 * u) * (1 + 2 * A1) <= v).
    { intros v C. assert (M : forall w', computed x (Times (2 # 1) (Mul (Given error_w 0) (Given inverse 0))) w' ->
        Rmax 0 ((1 - u) * (2 * A1) - 3 * h32) <= w').
      { intros w' D. apply Rmax_lub.
        - apply (positive_is x _ _) in D; [exact D | cbn -[Q2R]; rewrite Q2R_2; fold f z; repeat split; lra].
        - assert (N := least_times x (2 # 1) _ A1 w' D ltac:(rewrite Q2R_2; lra) A10 L1). rewrite Q2R_2 in N. lra. }
      assert (N := least_add x _ _ 1 _ v C ltac:(lra) (Rmax_l _ _) ltac:(intros ? D; apply least_const in D; rewrite Q2R_1 in D;
        exact D) M). assert (X := Rmax_r 0 ((1 - u) * (2 * A1) - 3 * h32)). lra. }
    set (A2 := (1 - 22 / 10 * u) * (1 + 2 * A1)) in *. assert (A20 : 0 <= A2) by (unfold A2; apply Rmult_le_pos; lra).
    set (A3 := Rmax 0 ((1 - 6 * u) * T - / 2 ^ 33)). assert (A30 : 0 <= A3) by apply Rmax_l.
    assert (A31 : (1 - 6 * u) * T - / 2 ^ 33 <= A3) by apply Rmax_r. simpl in A31.
    assert (L3 : forall v, computed x (Mul (Add (Const (1 # 1)) (Times (2 # 1) (Mul (Given error_w 0) (Given inverse 0))))
      (Mul (Given error_w 0) (Given inverse 0))) v -> A3 <= v).
    { intros v C. apply Rmax_lub.
      - apply (positive_is x _ _) in C; [exact C | cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold f z; repeat split; lra].
      - assert (N := least_mul x _ _ A2 A1 v C A20 A10 L2 L1).
        assert (K : (1 - 22 / 10 * u) * r * r - 103 / 100 * / 2 ^ 35 <= A1 * A1).
        { destruct (Rle_dec 0 ((1 - 11 / 10 * u) * r - / 2 ^ 35)) as [pos | neg].
          - assert (K := Rmult_le_compat _ _ _ _ pos pos A11 A11). assert (rr := Rmult_le_pos _ _ r0 r0). simpl in K. simpl. lra.
          - assert (0 <= A1 * A1) by (now apply Rmult_le_pos). simpl in neg.
            assert (rr := Rmult_le_compat_l r r 1 r0 ltac:(lra)). simpl.
            assert (0 <= r * r) by (now apply Rmult_le_pos). lra. }
        simpl in K. assert (h32 * A1 <= h32) by (assert (G := Rmult_le_compat_l h32 _ _ ltac:(lra) A12); lra).
        assert (rr := Rmult_le_pos _ _ r0 r0). unfold A2, T in *. simpl. lra. }
    set (A4 := (1 - 8 * u) * (598 / 100 * u + T) - / 2 ^ 32).
    assert (k_less : Q2R k <= 2) by exact k_most.
    assert (L4 : forall v, computed x (Add (Const k) (Mul (Add (Const (1 # 1)) (Times (2 # 1) (Mul (Given error_w 0)
      (Given inverse 0)))) (Mul (Given error_w 0) (Given inverse 0)))) v -> Rmax 0 A4 <= v).
    { intros v C. apply Rmax_lub.
      - apply (positive_is x _ _) in C; [exact C | cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold f z; repeat split; lra].
      - assert (N := least_add x _ _ (Q2R k) A3 v C ltac:(lra) A30 ltac:(intros ? D; apply least_const in D; exact D) L3).
        unfold A4. simpl. lra. }
    assert (T1 : T <= 2) by (unfold T; assert (G := Rmult_le_compat r (51 / 100) (1 + 2 * r) (202 / 100) r0 ltac:(lra) r1
      ltac:(lra)); lra).
    assert (A41 := Rmax_r 0 A4). assert (A42 : Rmax 0 A4 <= 3) by (apply Rmax_lub; [lra | unfold A4; simpl; lra]).
    assert (hz2 := Rmult_le_compat_r z _ _ ltac:(lra) (proj2 l)).
    assert (L5 : forall v, computed x (Mul (Add (Const k) (Mul (Add (Const (1 # 1)) (Times (2 # 1) (Mul (Given error_w 0)
      (Given inverse 0)))) (Mul (Given error_w 0) (Given inverse 0)))) (Given inverse 0)) v ->
      Rmax 0 ((1 - u) * (A4 * z) - / 2 ^ 60 * z) <= v).
    { intros v C. apply Rmax_lub.
      - apply (positive_is x _ _) in C; [exact C | cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold f z; repeat split; lra].
      - assert (N := least_mul x _ _ _ z v C (Rmax_l 0 A4) ltac:(lra) L4 ltac:(intros ? D; apply least_given in D; exact D)).
        assert (G := Rmult_le_compat_r z _ _ ltac:(lra) A41). assert (G2 := Rmult_le_compat_l h32 _ _ ltac:(lra) A42). simpl. lra. }
    assert (N := least_times x i _ _ s Cs ltac:(lra) (Rmax_l _ _) L5).
    assert (X := Rmax_r 0 ((1 - u) * (A4 * z) - / 2 ^ 60 * z)).
    assert (X2 := Rmult_le_compat_r _ _ _ (Rmax_l 0 ((1 - u) * (A4 * z) - / 2 ^ 60 * z)) i1).
    assert (ih := Rmult_le_compat_r h32 _ _ ltac:(lra) i_less). unfold A4 in *. simpl in X, X2, N |- *. lra.
  - assert (w_b := between _ _ w_near). assert (W0 : 0 < x w - f <= W) by lra.
    assert (t_r : t <= (1 + 502 / 100 * u) * r).
    { unfold t, r. assert (K := Rmult_le_compat_l f _ _ f1 z2). lra. }
    assert (t_T : t * (1 + 2 * t) <= (1 + 101 / 10 * u) * T).
    { assert (K := Rmult_le_compat t ((1 + 502 / 100 * u) * r) (1 + 2 * t) ((1 + 502 / 100 * u) * (1 + 2 * r))
      ltac:(lra)
        ltac:(lra) t_r ltac:(lra)). unfold T. unfold T in T0. lra. }
    split.
    + assert (K := Rinv_le_contravar _ _ (proj1 W0) (proj2 W0)). assert (K2 := inverse_of_difference).
      assert (K3 : / (x w - f) <= / x w * (1 + t * (1 + 2 * t))).
      { assert (K4 := Rmult_le_compat_l t (/ (x w - f)) _ t0 K2).
        replace (/ (x w - f)) with (/ x w * (1 + f * / (x w - f))) at 1 by (field; lra).
        apply Rmult_le_compat_l; [lra |]. assert (K5 := Rmult_le_compat_l f _ _ f1 K2). unfold t at 1. lra. }
      assert (K6 : 0 <= t * (1 + 2 * t)) by (apply Rmult_le_pos; lra).
      assert (K7 := Rmult_le_compat (/ x w) ((1 + 502 / 100 * u) * z) (1 + t * (1 + 2 * t)) (1 + (1 + 101 / 10 * u) *
        T)
        ltac:(lra) ltac:(lra) z2 ltac:(lra)). lra.
    + assert (K := Rinv_le_contravar W (x w + f) ltac:(lra) ltac:(lra)).
      assert (K2 : / x w * (1 - t) <= / (x w + f)).
      { apply Rmult_le_reg_r with (x w + f); [lra |]. rewrite Rinv_l by lra.
        replace (/ x w * (1 - t) * (x w + f)) with (1 - t * t) by (unfold t; field; lra).
        assert (0 <= t * t) by (apply Rmult_le_pos; lra). lra. }
      assert (K3 : (1 - 502 / 100 * u) * z <= / x w) by lra.
      assert (K4 := Rmult_le_compat_l (/ x w) _ _ ltac:(lra) t_r).
      assert (K5 : / x w * t <= (1 + 502 / 100 * u) * z * ((1 + 502 / 100 * u) * r)) by (apply Rmult_le_compat; lra).
        lra.
Qed.
Theorem low_height_is_below v : computed x (Sub (Given inverse 0) (of_height_of i k)) v -> v <= / W.
Proof.
  intros C. destruct (step32_sub _ _ _ _ C) as (z1 & s & C1 & C2 & R). apply given32_is in C1. subst z1. fold z in R.
  destruct (of_height_is_enough s C2) as (A & _ & B). destruct z_in as (z0 & _ & _). assert (f1 := f0).
  set (T := f * z * (1 + 2 * (f * z)) * z) in *.
  assert (T0 : 0 <= T) by (unfold T; assert (0 <= f * z) by (apply Rmult_le_pos; lra); repeat apply Rmult_le_pos;
    lra).
  assert (l := h32_below). destruct w_sizes as (w0 & w1 & w2). destruct z_in as (_ & z1 & _). simpl in l, w1.
  assert (S : Rabs (z - s) <= z + s) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ R) in S. apply between in S. lra.
Qed.
Theorem high_height_is_above v : computed x (Add (Given inverse 0) (of_height_of i k)) v -> / W <= v.
Proof.
  intros C. destruct (step32_add _ _ _ _ C) as (z1 & s & C1 & C2 & R). apply given32_is in C1. subst z1. fold z in R.
  destruct (of_height_is_enough s C2) as (A & B & _). destruct z_in as (z0 & _ & _). assert (f1 := f0).
  set (T := f * z * (1 + 2 * (f * z)) * z) in *.
  assert (T0 : 0 <= T) by (unfold T; assert (0 <= f * z) by (apply Rmult_le_pos; lra); repeat apply Rmult_le_pos;
    lra).
  assert (l := h32_below). destruct w_sizes as (w0 & w1 & w2). destruct z_in as (_ & z1 & _). simpl in l, w1.
  assert (S : Rabs (z + s) <= z + s) by (apply Rabs_le; lra). apply (at_most32 _ _ _ _ R) in S. apply between in S. lra.
Qed.
End Inverse.

(* ---- A direction: h itself is the coordinate ---- *)
Hypothesis e_is : / 2 ^ 24 <= e.
Lemma parallel_is_enough s : computed x (parallel_of i c) s ->
  0 <= s /\ e + 201 / 100 * u * (Rabs (x h) + s) + few <= s.
Proof.
  intros Cs. assert (e1 := e0). assert (c1 := c_is). assert (i1 := i_is). assert (h0 := Rabs_pos (x h)).
  destruct h_is as [l ll]. assert (e_low := e_is). simpl in l, e_low.
  assert (Ns := near_from_below _ _ (Q2R i * (e + Q2R c * Rabs (x h))) 3 (40 * h32) Cs eq_refl ltac:(cbn -[Q2R]; fold e;
    rewrite (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq (Q2R c)), (Rabs_pos_eq e) by lra; reflexivity) eq_refl ltac:(lia)).
  specialize (Ns ltac:(unfold lost32; cbn -[u32 h32 Q2R]; rewrite (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq (Q2R c)), !u32_value by lra;
    assert (ch := Rmult_le_compat_r (h32 + h32) _ _ ltac:(lra) c_less);
    match goal with |- _ * (Q2R i * ?y) + _ <= _ => assert (0 <= y) by (repeat first [lra | apply
      Rplus_le_le_0_compat | apply Rmult_le_pos]); assert (ih := Rmult_le_compat_r y _ _ ltac:(assumption) i_less) end; lra)).
  simpl INR in Ns. assert (B := times_both _ _ e1 h0).
  assert (s0 : 0 <= s) by (apply (positive_is x (parallel_of i c)); [cbn -[Q2R]; fold e; repeat split; lra | exact Cs]). split; lra.
Qed.
Theorem low_side_is_below_parallel v :
  computed x (Sub (Sub (Given h 0) (parallel_of i c)) (Given point_error 0)) v -> v <= H - E.
Proof.
  intros C. destruct (step32_sub _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given32_is in C2. subst p1.
  destruct (step32_sub _ _ _ _ C1) as (q1 & s & C3 & C4 & R1). apply given32_is in C3. subst q1.
  destruct (parallel_is_enough s C4) as (s0 & B). eapply moved_down; eassumption.
Qed.
Theorem high_side_is_above_parallel v :
  computed x (Add (Add (Given h 0) (parallel_of i c)) (Given point_error 0)) v -> H + E <= v.
Proof.
  intros C. destruct (step32_add _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given32_is in C2. subst p1.
  destruct (step32_add _ _ _ _ C1) as (q1 & s & C3 & C4 & R1). apply given32_is in C3. subst q1.
  destruct (parallel_is_enough s C4) as (s0 & B). eapply moved_up; eassumption.
Qed.

(* ---- Near W = 0 ---- *)
Section Near.
Variable X : R.
Hypotheses (X_in : Rabs X <= x reach) (e_least : / 2 ^ 90 <= e) (near_least : / 2 ^ 90 <= f <= 16777216 * e) (w_near_zero : Rabs (x w) <= 2 * f).
Lemma near_zero_is_enough s : computed x (near_zero_of i) s -> Rabs (H - X * W - x h) + 10 * h32 <= s.
Proof.
  intros Cs. assert (e1 := e0). assert (f1 := f0). assert (i1 := i_is). assert (w0 := Rabs_pos (x w)).
  destruct h_is as [l ll]. simpl in l, ll. assert (f_is := near_least). assert (e_low := e_least). simpl in e_low. simpl in f_is.
  set (r := x reach) in *. assert (r0 : 0 <= r) by (eapply Rle_trans; [apply Rabs_pos | exact X_in]).
  set (G := (Rabs (x w) + f) * r). assert (G0 : 0 <= G) by (unfold G; apply Rmult_le_pos; lra).
  assert (sum : forall v, computed x (Add (Abs (Given w 0)) (Given error_w 0)) v -> (1 - 11 / 10 * u) * (Rabs (x w) + f) <= v).
  { intros v C. assert (N := least_add x _ _ (Rmax 0 (Rabs (x w) - h32)) f v C (Rmax_l _ _) f1
      ltac:(intros p' D; apply Rmax_lub; [exact (positive_is x (Abs (Given w 0)) p' I D) | now apply least_abs_given])
      ltac:(intros ? D; apply least_given in D; exact D)). assert (M := Rmax_r 0 (Rabs (x w) - h32)). lra. }
  assert (product : forall v, computed x (Mul (Add (Abs (Given w 0)) (Given error_w 0)) (Given reach 0)) v ->
    Rmax 0 ((1 - 22 / 10 * u) * G - 100 * h32 - / 1000 * u * e) <= v).
  { intros v C. apply Rmax_lub; [apply (positive_is x _ _) in C; [exact C | cbn; fold f r; repeat split; lra] |].
    assert (N := least_mul x _ _ ((1 - 11 / 10 * u) * (Rabs (x w) + f)) r v C ltac:(apply Rmult_le_pos; lra) r0 sum
      ltac:(intros ? D; apply least_given in D; exact D)). unfold G.
    assert (hw := Rmult_le_compat_l h32 _ _ ltac:(lra) w_near_zero).
    assert (hf := Rmult_le_compat_l h32 _ _ ltac:(lra) (proj2 f_is)).
    assert (hr := Rmult_le_compat_r r h32 (/ 1000 * u * f) r0 ltac:(lra)).
    assert (wr : 0 <= Rabs (x w) * r) by (now apply Rmult_le_pos). assert (fr : 0 <= f * r) by (now apply Rmult_le_pos). assert (he := Rmult_le_compat_r e _ _ e1 (proj2 l)). lra. }
  assert (all : forall v, computed x (Add (Given error 0) (Mul (Add (Abs (Given w 0)) (Given error_w 0)) (Given reach 0))) v ->
    (1 - 34 / 10 * u) * (e + G) <= v).
  { intros v C. assert (N := least_add x _ _ e _ v C e1 (Rmax_l _ _) ltac:(intros ? D; apply least_given in D; exact D) product).
    assert (M := Rmax_r 0 ((1 - 22 / 10 * u) * G - 100 * h32 - / 1000 * u * e)). assert (he := Rmult_le_compat_r e _ _ e1 (proj2 l)). lra. }
  assert (Ns := least_times x i _ ((1 - 34 / 10 * u) * (e + G)) s Cs ltac:(lra) ltac:(apply Rmult_le_pos; lra) all).
  assert (B := Rmult_le_compat_r (e + G) _ _ ltac:(lra) i1). assert (ih := Rmult_le_compat_r h32 _ _ ltac:(lra) i_less).
  assert (W1 : Rabs W <= Rabs (x w) + f).
  { assert (T := Rabs_triang (x w) (- (x w - W))). rewrite Rabs_Ropp in T.
    replace (x w + - (x w - W)) with W in T by ring. lra. }
  assert (XW := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) W1 X_in). rewrite <- Rabs_mult in XW. fold G in XW.
  apply between in XW, h_near. assert (Z : Rabs (H - X * W - x h) <= e + G) by (apply Rabs_le; lra). lra.
Qed.
Theorem no_higher v : computed x (Add (Given h 0) (near_zero_of i)) v -> v <= 0 -> H - X * W <= 0.
Proof.
  intros C v0. destruct (step32_add _ _ _ _ C) as (h1 & s & C1 & C2 & R). apply given32_is in C1. subst h1.
  assert (A := near_zero_is_enough s C2). assert (l := h32_positive). assert (A' := between _ _ (Rle_refl (Rabs (H - X * W - x h)))).
  destruct (Rle_dec (x h + s) 0) as [L | G]; [lra |].
  rewrite (Rabs_pos_eq (x h + s)) in R by lra. apply between in R. lra.
Qed.
Theorem no_lower v : computed x (Sub (Given h 0) (near_zero_of i)) v -> 0 <= v -> 0 <= H - X * W.
Proof.
  intros C v0. destruct (step32_sub _ _ _ _ C) as (h1 & s & C1 & C2 & R). apply given32_is in C1. subst h1.
  assert (A := near_zero_is_enough s C2). assert (l := h32_positive). assert (A' := between _ _ (Rle_refl (Rabs (H - X * W - x h)))).
  destruct (Rle_dec 0 (x h - s)) as [L | G]; [lra |].
  rewrite (Rabs_left (x h - s)) in R by lra. apply between in R. lra.
Qed.
End Near.
End Vertex.

Lemma kernels_are_enough : (least_inflation <= inflation <= 2 /\ least_size <= of_size <= 1 /\ least_inverse <= of_inverse <= 2)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_size of_size.
Print constants.
Definition rests := Eval vm_compute in shown least_inverse of_inverse.
Print rests.
Definition checked := (kernels_are, low_side_is_below, high_side_is_above, low_side_in_front, high_side_in_front,
  low_side_is_below_parallel, high_side_is_above_parallel, low_height_is_below, high_height_is_above, no_higher,
    no_lower,
  kernels_are_enough).
Print Assumptions checked.
