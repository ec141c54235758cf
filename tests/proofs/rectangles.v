(* SPDX-License-Identifier: MIT *)
(* hull_bounds.clh: the sides of rectangles and the heights of hulls (docs/numerics.md, 5). H and W are what `h` and `w`
   are off from by at most `error` and `error_w`, E is what a point is off by:
     low_side_is_below, high_side_is_above       no side made of a vertex with |w| > 2 error_w cuts H / W -+ E;
     low_side_in_front, high_side_in_front       none by the slack of a hull that is wholly in front: 7.96 u of 8 u;
     low_side_is_below_parallel, ..._above_...   none under a direction, where 2 u would do: it is the same number;
     low_height_is_below, high_height_is_above   1 / W lies between both heights: 5.98 u of 6 u;
     no_higher, no_lower                         near W = 0 the sign of h +- slack is that of H - X W for all X.

   Assumed: a quotient is off by 2.5 ulp; `point_error` exceeds E by 2 u of itself (frame_errors.v: 10.1 u for 6.1 u),
   and so does height_error; no result is below 2^-126 unless it is 0. A slack's own roundings take 12 u of the 1 %; the
   rest is needed by 8 u and 6 u, which are proved with .99 % of it. Orders that rounding keeps: a hull's least product
   is at most each of them, its slack is made of the largest `size` and `nearest`. Overflow: an infinite slack gives no
   bound. *)
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

(* The kernel's text: the constants of its slacks. *)
Definition slack_of (i c : Q) := Times i (Add (Given quotient_2 0) (Times c (Abs (Given quotient_1 0)))).
Definition by_w := Mul (Add (Const (1 # 1)) (Times (2 # 1) (Mul (Given error_w 0) (Given nearest 0)))) (Given nearest
  0).
Definition in_front_of (i c : Q) :=
  Times i (Add (Mul (Add (Given error 0) (Mul (Given error_w 0) (Given size 0))) by_w) (Times c (Given size 0))).
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
  low_in_front = Sub (Sub product in_front) (Given point_error 0) /\
  high_in_front = Add (Add in_front product) (Given point_error 0) /\
  low_parallel = Sub (Sub (Given h 0) (parallel_of inflation of_size)) (Given point_error 0) /\
  high_parallel = Add (Add (Given h 0) (parallel_of inflation of_size)) (Given point_error 0) /\
  below_zero = Add (Given h 0) (near_zero_of inflation) /\ above_zero = Sub (Given h 0) (near_zero_of inflation) /\
  low_height = Sub (Given inverse 0) of_height /\ high_height = Add (Given inverse 0) of_height.
Proof. repeat split. Qed.

Definition least_inflation : Q := 10099 # 10000.
Definition least_size : Q := 796 # 1677721600.    (* of a product; of a quotient 6.97 u, under a direction 2 u *)
Definition least_inverse : Q := 598 # 1677721600.

(* What is subtracted, and then a point's error, with a rounding each. *)
Lemma moved_down q s p v1 v P V e : 0 <= s -> 0 <= e -> (1 + 2 * u) * e <= p -> Rabs (v1 - (q - s)) <= u * Rabs (q -
  s) ->
  Rabs (v - (v1 - p)) <= u * Rabs (v1 - p) -> Rabs (q - V) <= P -> P + 201 / 100 * u * (Rabs q + s) <= s -> v <= V -
    e.
Proof.
  intros s0 e0 Hp H1 H2 HV HP. assert (q0 := Rabs_pos q). assert (b := between _ _ (Rle_refl (Rabs q))).
  assert (T1 : Rabs (q - s) <= Rabs q + s) by (apply Rabs_le; lra).
  apply (at_most _ _ _ H1) in T1. apply between in T1.
  assert (T2 : Rabs (v1 - p) <= (1 + u) * (Rabs q + s) + p) by (apply Rabs_le; lra).
  apply (at_most _ _ _ H2) in T2. apply between in T2, HV. lra.
Qed.
Lemma moved_up q s p v1 v P V e : 0 <= s -> 0 <= e -> (1 + 2 * u) * e <= p -> Rabs (v1 - (q + s)) <= u * Rabs (q + s)
  ->
  Rabs (v - (v1 + p)) <= u * Rabs (v1 + p) -> Rabs (q - V) <= P -> P + 201 / 100 * u * (Rabs q + s) <= s -> V + e <=
    v.
Proof.
  intros s0 e0 Hp H1 H2 HV HP. assert (q0 := Rabs_pos q). assert (b := between _ _ (Rle_refl (Rabs q))).
  assert (T1 : Rabs (q + s) <= Rabs q + s) by (apply Rabs_le; lra).
  apply (at_most _ _ _ H1) in T1. apply between in T1.
  assert (T2 : Rabs (v1 + p) <= (1 + u) * (Rabs q + s) + p) by (apply Rabs_le; lra).
  apply (at_most _ _ _ H2) in T2. apply between in T2, HV. lra.
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
Hypotheses (i_in : Q2R least_inflation <= Q2R i) (c_in : Q2R least_size <= Q2R c).
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
Lemma near_from_below ex v P k : computed x ex v -> real x ex = P -> permanent x ex = P -> roundings ex = k -> (k <=
  16)%nat ->
  (1 - INR k * (1 + / 1048576) * u) * P <= v.
Proof.
  intros C R1 R2 K k16. apply near in C. rewrite R1, R2, K in C. assert (A := alpha_below k k16).
  assert (P0 : 0 <= P) by (rewrite <- R2; apply permanent_positive).
  assert (G := Rmult_le_compat_r P _ _ P0 A). apply between in C. lra.
Qed.

(* ---- A quotient of its own ---- *)
Section Quotient.
Let q := x quotient_1.
Hypotheses (far : 2 * f < Rabs (x w)) (q_near : Rabs (q - x h / x w) <= 501 / 100 * u * Rabs (x h / x w)).
Variables n d : R.
Hypotheses (Cn : computed x quotient_2_over n) (Cd : computed x quotient_2_under d).
Hypothesis q2_near : Rabs (x quotient_2 - n / d) <= 501 / 100 * u * Rabs (n / d).

Lemma slack_is_enough s : computed x (slack_of i c) s ->
  exists P, 0 <= s /\ Rabs (q - H / W) <= P /\ P + 201 / 100 * u * (Rabs q + s) <= s.
Proof.
  intros Cs. assert (e1 := e0). assert (f1 := f0). assert (q0 := Rabs_pos q).
  set (g := Rabs (x w) - f). assert (g0 : 0 < g) by (unfold g; lra). assert (I := Rinv_0_lt_compat _ g0).
  set (J := / g) in *. assert (M := quotient_moves _ _ _ _ _ _ h_near w_near ltac:(lra)). fold g J in M.
  set (Q := x h / x w) in *. set (t := f * J) in *. assert (t0 : 0 <= t) by (unfold t; apply Rmult_le_pos; lra).
  assert (t1 : t <= 1).
  { unfold t. replace 1 with (g * J) by (unfold J; field; lra). apply Rmult_le_compat_r; unfold g; lra. }
  assert (eJ : 0 <= e * J) by (apply Rmult_le_pos; lra).
  assert (T := Rabs_triang_inv Q (Q - q)). replace (Q - (Q - q)) with q in T by ring. rewrite (Rabs_minus_sym Q) in T.
  assert (Q1 : Rabs Q <= (1 + 502 / 100 * u) * Rabs q) by lra. assert (Q0 := Rabs_pos Q).
  assert (Qt := Rmult_le_compat_r t _ _ t0 Q1). assert (qt : 0 <= Rabs q * t) by (now apply Rmult_le_pos).
  assert (qt1 : Rabs q * t <= Rabs q) by (assert (K := Rmult_le_compat_l _ _ _ q0 t1); lra).
  (* The computed quotient of the errors. *)
  assert (Nn := near_from_below _ _ (e + Rabs q * f) 2 Cn eq_refl ltac:(cbn; fold e f q; rewrite (Rabs_pos_eq e),
    (Rabs_pos_eq f) by lra; reflexivity) eq_refl ltac:(lia)). simpl INR in Nn. destruct (step_sub _ _ _ _ Cd) as (a &
      b & Ca & Cb & S). apply given_is in Cb. subst b.
  assert (a_is : a = Rabs (x w)).
  { clear - Ca. destruct Ca as [C L]. inversion C as [ | | | | | ? r z D G | | | | ]; subst. unfold seen64 in G.
    subst.
    f_equal. apply given_is. split; [exact D | exact L]. }
  subst a. fold f g in S. rewrite (Rabs_pos_eq g) in S by lra. apply between in S.
  assert (d0 : 0 < d) by lra. assert (ef : 0 <= e + Rabs q * f) by (assert (0 <= Rabs q * f) by (now apply
    Rmult_le_pos); lra).
  assert (D1 : (1 - 2 * u) * J <= / d).
  { apply Rmult_le_reg_r with d; [lra |]. rewrite Rinv_l by lra.
    assert (K := Rmult_le_compat_l J d ((1 + u) * g) ltac:(lra) ltac:(lra)).
    replace (J * ((1 + u) * g)) with (1 + u) in K by (unfold J; field; lra).
    assert (K2 := Rmult_le_compat_l (1 - 2 * u) _ _ ltac:(lra) K). lra. }
  assert (N : (1 - 41 / 10 * u) * (e * J + Rabs q * t) <= n / d).
  { assert (K := Rmult_le_compat ((1 - 21 / 10 * u) * (e + Rabs q * f)) n ((1 - 2 * u) * J) (/ d) ltac:(apply
      Rmult_le_pos; lra) ltac:(apply Rmult_le_pos; lra) ltac:(lra) D1).
    assert (qt2 : 0 <= Rabs q * (f * J)) by exact qt. unfold t, Rdiv. lra. }
  assert (nd0 : 0 <= n / d) by (eapply Rle_trans; [| exact N]; apply Rmult_le_pos; lra).
  rewrite (Rabs_pos_eq (n / d)) in q2_near by exact nd0. apply between in q2_near.
  assert (q2 : (1 - 92 / 10 * u) * (e * J + Rabs q * t) <= x quotient_2) by lra.
  assert (q20 : 0 <= x quotient_2) by (eapply Rle_trans; [| exact q2]; apply Rmult_le_pos; lra).
  assert (c1 := c_is). assert (i1 := i_is).
  assert (Ns := near_from_below _ _ (Q2R i * (x quotient_2 + Q2R c * Rabs q)) 3 Cs eq_refl ltac:(cbn -[Q2R]; fold q;
    rewrite (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq (Q2R c)), (Rabs_pos_eq (x quotient_2)) by lra; reflexivity) eq_refl
    ltac:(lia)). simpl INR in Ns. assert (B := times_both _ _ q20 q0).
  exists (501 / 100 * u * Rabs Q + (e * J + Rabs Q * t)). repeat split.
  - lra.
  - assert (T2 := Rabs_triang (q - Q) (Q - H / W)). replace (q - Q + (Q - H / W)) with (q - H / W) in T2 by ring. lra.
  - lra.
Qed.

Theorem low_side_is_below v : computed x (Sub (Sub (Given quotient_1 0) (slack_of i c)) (Given point_error 0)) v -> v
  <= H /
  W - E.
Proof.
  intros C. destruct (step_sub _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given_is in C2. subst p1.
  destruct (step_sub _ _ _ _ C1) as (q1 & s & C3 & C4 & R1). apply given_is in C3. subst q1.
  destruct (slack_is_enough s C4) as (P & s0 & A & B). eapply moved_down; eassumption.
Qed.
Theorem high_side_is_above v : computed x (Add (Add (Given quotient_1 0) (slack_of i c)) (Given point_error 0)) v ->
  H / W
  + E <= v.
Proof.
  intros C. destruct (step_add _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given_is in C2. subst p1.
  destruct (step_add _ _ _ _ C1) as (q1 & s & C3 & C4 & R1). apply given_is in C3. subst q1.
  destruct (slack_is_enough s C4) as (P & s0 & A & B). eapply moved_up; eassumption.
Qed.
End Quotient.

(* ---- A product with the reciprocal ---- *)
Section Inverse.
Let z := x inverse.
Hypotheses (front : 2 * f < x w) (z_near : Rabs (z - / x w) <= 501 / 100 * u * / x w).
Let t := f * / x w.
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
Lemma z_in : 0 < z /\ (1 - 501 / 100 * u) * / x w <= z /\ / x w <= (1 + 502 / 100 * u) * z.
Proof.
  assert (f1 := f0). assert (w0 : 0 < x w) by lra. assert (I := Rinv_0_lt_compat _ w0).
  assert (B := between _ _ z_near). repeat split; lra.
Qed.

Hypotheses (size_is : forall y, computed x product y -> Rabs y <= x size) (nearest_is : z <= x nearest).
Lemma in_front_is_enough s y : computed x (in_front_of i c) s -> computed x product y ->
  exists P, 0 <= s /\ Rabs (y - H / W) <= P /\ P + 201 / 100 * u * (Rabs y + s) <= s.
Proof.
  intros Cs Cy. assert (y_in := size_is y Cy). assert (e1 := e0). assert (f1 := f0). assert (w0 : 0 < x w) by lra.
  assert (I := Rinv_0_lt_compat _ w0). destruct t_in as [t0 t1]. destruct z_in as (z0 & z1 & z2). assert (y0 :=
    Rabs_pos y).
  assert (M := quotient_moves _ _ _ _ _ _ h_near w_near ltac:(rewrite (Rabs_pos_eq (x w)); lra)).
  rewrite (Rabs_pos_eq (x w)) in M by lra.
  set (J := / (x w - f)) in *. assert (J0 : 0 < J) by (apply Rinv_0_lt_compat; lra). set (Q := x h / x w) in *.
  set (r := f * J) in *. assert (r0 : 0 <= r) by (unfold r; apply Rmult_le_pos; lra).
  assert (r1 : r <= 1).
  { unfold r. replace 1 with ((x w - f) * J) by (unfold J; field; lra). apply Rmult_le_compat_r; lra. }
  (* The product. *)
  destruct (step_mul _ _ _ _ Cy) as (h1 & i1 & C1 & C2 & Y). apply given_is in C1, C2. subst h1 i1. fold z in Y.
  assert (Y2 : Rabs (x h * z - Q) <= 501 / 100 * u * Rabs Q).
  { unfold Q, Rdiv. rewrite <- Rmult_minus_distr_l, !Rabs_mult, (Rabs_pos_eq (/ x w)) by lra.
    assert (K := Rmult_le_compat_l _ _ _ (Rabs_pos (x h)) z_near). lra. }
  assert (T := Rabs_triang (x h * z - Q) Q). replace (x h * z - Q + Q) with (x h * z) in T by ring.
  assert (Q0 := Rabs_pos Q).
  assert (Y3 : Rabs (y - Q) <= 602 / 100 * u * Rabs Q).
  { assert (T2 := Rabs_triang (y - x h * z) (x h * z - Q)). replace (y - x h * z + (x h * z - Q)) with (y - Q) in T2
    by ring.
    lra. }
  assert (T3 := Rabs_triang_inv Q (Q - y)). replace (Q - (Q - y)) with y in T3 by ring. rewrite (Rabs_minus_sym Q) in
    T3.
  set (S := x size) in *. assert (S0 : 0 <= S) by lra. assert (Q1 : Rabs Q <= (1 + 603 / 100 * u) * S) by lra.
  assert (Qr := Rmult_le_compat_r r _ _ r0 Q1). assert (Sr : 0 <= S * r) by (now apply Rmult_le_pos).
  assert (Sr1 : S * r <= S) by (assert (K := Rmult_le_compat_l _ _ _ S0 r1); lra).
  assert (eJ : 0 <= e * J) by (apply Rmult_le_pos; lra).
  (* The reciprocal's bound. *)
  set (m := x nearest) in *. assert (m0 : 0 < m) by lra. set (B := (1 + 2 * (f * m)) * m).
  assert (fm : (1 - 501 / 100 * u) * t <= f * m).
  { unfold t. assert (K := Rmult_le_compat_l f _ _ f1 (Rle_trans _ _ _ z1 nearest_is)). lra. }
  assert (B1 : (1 - 101 / 10 * u) * J <= B).
  { assert (K := inverse_of_difference). fold J in K. unfold B.
    assert (K2 := Rmult_le_compat (1 + 2 * ((1 - 501 / 100 * u) * t)) _ ((1 - 501 / 100 * u) * / x w) m ltac:(lra)
      ltac:(apply Rmult_le_pos; lra) (Rplus_le_compat_l 1 _ _ (Rmult_le_compat_l 2 _ _ ltac:(lra) fm)) ltac:(lra)).
    assert (K3 : (1 - 501 / 100 * u) * (1 + 2 * t) <= 1 + 2 * ((1 - 501 / 100 * u) * t)) by lra.
    assert (K4 := Rmult_le_compat_r ((1 - 501 / 100 * u) * / x w) _ _ ltac:(apply Rmult_le_pos; lra) K3).
    assert (K5 := Rmult_le_compat_l (1 - 101 / 10 * u) _ _ ltac:(lra) K).
    assert (K6 : 0 <= / x w * (1 + 2 * t)) by (apply Rmult_le_pos; lra). lra. }
  assert (eS : 0 <= e + f * S) by (assert (0 <= f * S) by (now apply Rmult_le_pos); lra).
  assert (A := Rmult_le_compat_l _ _ _ eS B1). assert (B0 : 0 <= B) by (eapply Rle_trans; [| exact B1]; apply
    Rmult_le_pos; lra).
  assert (c1 := c_is). assert (i2 := i_is).
  assert (Ns := near_from_below _ _ (Q2R i * ((e + f * S) * B + Q2R c * S)) 9 Cs ltac:(cbn -[Q2R]; unfold B;
    rewrite Q2R_1, Q2R_2; reflexivity) ltac:(cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold e f S m; rewrite (Rabs_pos_eq
      (Q2R i)),
    (Rabs_pos_eq (Q2R c)), (Rabs_pos_eq e), (Rabs_pos_eq f), (Rabs_pos_eq S), (Rabs_pos_eq m), (Rabs_pos_eq 1),
    (Rabs_pos_eq 2) by lra; reflexivity) eq_refl ltac:(lia)). simpl INR in Ns. assert (D := times_both ((e + f * S) *
      B) S ltac:(apply Rmult_le_pos; lra) S0).
  replace ((e + f * S) * ((1 - 101 / 10 * u) * J)) with ((1 - 101 / 10 * u) * (e * J + S * r)) in A by (unfold r;
    ring).
  exists (602 / 100 * u * Rabs Q + (e * J + Rabs Q * r)). repeat split.
  - lra.
  - assert (T2 := Rabs_triang (y - Q) (Q - H / W)). replace (y - Q + (Q - H / W)) with (y - H / W) in T2 by ring. lra.
  - lra.
Qed.
Theorem low_side_in_front v : computed x (Sub (Sub product (in_front_of i c)) (Given point_error 0)) v -> v <= H / W
  - E.
Proof.
  intros C. destruct (step_sub _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given_is in C2. subst p1.
  destruct (step_sub _ _ _ _ C1) as (y & s & C3 & C4 & R1).
  destruct (in_front_is_enough s y C4 C3) as (P & s0 & A & B). eapply moved_down; eassumption.
Qed.
Theorem high_side_in_front v : computed x (Add (Add (in_front_of i c) product) (Given point_error 0)) v -> H / W + E
  <= v.
Proof.
  intros C. destruct (step_add _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given_is in C2. subst p1.
  destruct (step_add _ _ _ _ C1) as (s & y & C4 & C3 & R1). rewrite (Rplus_comm s) in R1.
  destruct (in_front_is_enough s y C4 C3) as (P & s0 & A & B). eapply moved_up; eassumption.
Qed.

(* ---- Heights ---- *)
Variable k : Q.
Hypothesis k_in : Q2R least_inverse <= Q2R k.
Lemma of_height_is_enough s : computed x (of_height_of i k) s ->
  10098 / 10000 * (598 / 100 * u * z + f * z * (1 + 2 * (f * z)) * z) <= s /\
  / W <= z + (502 / 100 * u * z + (1 + 16 * u) * (f * z * (1 + 2 * (f * z)) * z)) /\
  z - (502 / 100 * u * z + (1 + 16 * u) * (f * z * (1 + 2 * (f * z)) * z)) <= / W.
Proof.
  intros Cs. assert (f1 := f0). assert (w0 : 0 < x w) by lra. assert (I := Rinv_0_lt_compat _ w0).
  destruct t_in as [t0 t1]. destruct z_in as (z0 & z1 & z2). assert (i1 := i_is).
  assert (k1 : 598 / 100 * u <= Q2R k) by (revert k_in; unfold Q2R at 1, least_inverse; simpl; lra).
  set (r := f * z) in *. assert (r0 : 0 <= r) by (unfold r; apply Rmult_le_pos; lra).
  set (T := r * (1 + 2 * r)) in *. assert (T0 : 0 <= T) by (unfold T; apply Rmult_le_pos; lra).
  assert (rT : r <= T) by (unfold T; assert (0 <= r * r) by (now apply Rmult_le_pos); lra).
  assert (rz : 0 <= r * z) by (apply Rmult_le_pos; lra). assert (Tz := Rmult_le_compat_r z _ _ ltac:(lra) rT).
  split.
  - assert (Ns := near_from_below _ _ (Q2R i * ((Q2R k + T) * z)) 8 Cs ltac:(cbn -[Q2R]; unfold T, r; rewrite Q2R_1,
    Q2R_2;
      fold f z; ring) ltac:(cbn -[Q2R]; rewrite Q2R_1, Q2R_2; fold f z; rewrite (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq
        (Q2R k)),
      (Rabs_pos_eq f), (Rabs_pos_eq z), (Rabs_pos_eq 1), (Rabs_pos_eq 2) by lra; unfold T, r; ring) eq_refl
        ltac:(lia)).
    simpl INR in Ns. assert (A : (598 / 100 * u + T) * z <= (Q2R k + T) * z) by (apply Rmult_le_compat_r; lra).
    assert (A0 : 0 <= (598 / 100 * u + T) * z) by (apply Rmult_le_pos; lra).
    assert (B := Rmult_le_compat (10099 / 10000) (Q2R i) _ _ ltac:(lra) A0 i1 A). lra.
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
      assert (K3 : (1 - 502 / 100 * u) * z <= / x w) by (assert (z_b := between _ _ z_near); lra).
      assert (K4 := Rmult_le_compat_l (/ x w) _ _ ltac:(lra) t_r).
      assert (K5 : / x w * t <= (1 + 502 / 100 * u) * z * ((1 + 502 / 100 * u) * r)) by (apply Rmult_le_compat; lra).
        lra.
Qed.
Theorem low_height_is_below v : computed x (Sub (Given inverse 0) (of_height_of i k)) v -> v <= / W.
Proof.
  intros C. destruct (step_sub _ _ _ _ C) as (z1 & s & C1 & C2 & R). apply given_is in C1. subst z1. fold z in R.
  destruct (of_height_is_enough s C2) as (A & _ & B). destruct z_in as (z0 & _ & _). assert (f1 := f0).
  set (T := f * z * (1 + 2 * (f * z)) * z) in *.
  assert (T0 : 0 <= T) by (unfold T; assert (0 <= f * z) by (apply Rmult_le_pos; lra); repeat apply Rmult_le_pos;
    lra).
  assert (S : Rabs (z - s) <= z + s) by (apply Rabs_le; lra). apply (at_most _ _ _ R) in S. apply between in S. lra.
Qed.
Theorem high_height_is_above v : computed x (Add (Given inverse 0) (of_height_of i k)) v -> / W <= v.
Proof.
  intros C. destruct (step_add _ _ _ _ C) as (z1 & s & C1 & C2 & R). apply given_is in C1. subst z1. fold z in R.
  destruct (of_height_is_enough s C2) as (A & B & _). destruct z_in as (z0 & _ & _). assert (f1 := f0).
  set (T := f * z * (1 + 2 * (f * z)) * z) in *.
  assert (T0 : 0 <= T) by (unfold T; assert (0 <= f * z) by (apply Rmult_le_pos; lra); repeat apply Rmult_le_pos;
    lra).
  assert (S : Rabs (z + s) <= z + s) by (apply Rabs_le; lra). apply (at_most _ _ _ R) in S. apply between in S. lra.
Qed.
End Inverse.

(* ---- A direction: h itself is the coordinate ---- *)
Lemma parallel_is_enough s : computed x (parallel_of i c) s ->
  0 <= s /\ e + 201 / 100 * u * (Rabs (x h) + s) <= s.
Proof.
  intros Cs. assert (e1 := e0). assert (c1 := c_is). assert (i1 := i_is). assert (h0 := Rabs_pos (x h)).
  assert (Ns := near_from_below _ _ (Q2R i * (e + Q2R c * Rabs (x h))) 3 Cs eq_refl ltac:(cbn -[Q2R]; fold e;
    rewrite (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq (Q2R c)), (Rabs_pos_eq e) by lra; reflexivity) eq_refl ltac:(lia)).
  simpl INR in Ns. assert (B := times_both _ _ e1 h0). split; lra.
Qed.
Theorem low_side_is_below_parallel v :
  computed x (Sub (Sub (Given h 0) (parallel_of i c)) (Given point_error 0)) v -> v <= H - E.
Proof.
  intros C. destruct (step_sub _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given_is in C2. subst p1.
  destruct (step_sub _ _ _ _ C1) as (q1 & s & C3 & C4 & R1). apply given_is in C3. subst q1.
  destruct (parallel_is_enough s C4) as (s0 & B). eapply moved_down; eassumption.
Qed.
Theorem high_side_is_above_parallel v :
  computed x (Add (Add (Given h 0) (parallel_of i c)) (Given point_error 0)) v -> H + E <= v.
Proof.
  intros C. destruct (step_add _ _ _ _ C) as (v1 & p1 & C1 & C2 & R2). apply given_is in C2. subst p1.
  destruct (step_add _ _ _ _ C1) as (q1 & s & C3 & C4 & R1). apply given_is in C3. subst q1.
  destruct (parallel_is_enough s C4) as (s0 & B). eapply moved_up; eassumption.
Qed.

(* ---- Near W = 0 ---- *)
Section Near.
Variable X : R.
Hypothesis X_in : Rabs X <= x reach.
Lemma near_zero_is_enough s : computed x (near_zero_of i) s -> Rabs (H - X * W - x h) <= s.
Proof.
  intros Cs. assert (e1 := e0). assert (f1 := f0). assert (i1 := i_is). assert (w0 := Rabs_pos (x w)).
  set (r := x reach) in *. assert (r0 : 0 <= r) by (eapply Rle_trans; [apply Rabs_pos | exact X_in]).
  assert (Ns := near_from_below _ _ (Q2R i * (e + (Rabs (x w) + f) * r)) 4 Cs eq_refl ltac:(cbn -[Q2R]; fold e f r;
    rewrite (Rabs_pos_eq (Q2R i)), (Rabs_pos_eq e), (Rabs_pos_eq f), (Rabs_pos_eq r) by lra; reflexivity) eq_refl
      ltac:(lia)).
  simpl INR in Ns. set (G := (Rabs (x w) + f) * r) in *. assert (G0 : 0 <= G) by (unfold G; apply Rmult_le_pos; lra).
  assert (B := Rmult_le_compat_r (e + G) _ _ ltac:(lra) i1).
  assert (W1 : Rabs W <= Rabs (x w) + f).
  { assert (T := Rabs_triang (x w) (- (x w - W))). rewrite Rabs_Ropp in T.
    replace (x w + - (x w - W)) with W in T by ring. lra. }
  assert (XW := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) W1 X_in). rewrite <- Rabs_mult in XW. fold G in XW.
  apply between in XW, h_near. apply Rabs_le. lra.
Qed.
Theorem no_higher v : computed x (Add (Given h 0) (near_zero_of i)) v -> v <= 0 -> H - X * W <= 0.
Proof.
  intros C v0. destruct (step_add _ _ _ _ C) as (h1 & s & C1 & C2 & R). apply given_is in C1. subst h1.
  assert (A := between _ _ (near_zero_is_enough s C2)). destruct (Rle_dec (x h + s) 0) as [L | G]; [lra |].
  rewrite (Rabs_pos_eq (x h + s)) in R by lra. apply between in R. lra.
Qed.
Theorem no_lower v : computed x (Sub (Given h 0) (near_zero_of i)) v -> 0 <= v -> 0 <= H - X * W.
Proof.
  intros C v0. destruct (step_sub _ _ _ _ C) as (h1 & s & C1 & C2 & R). apply given_is in C1. subst h1.
  assert (A := between _ _ (near_zero_is_enough s C2)). destruct (Rle_dec 0 (x h - s)) as [L | G]; [lra |].
  rewrite (Rabs_left (x h - s)) in R by lra. apply between in R. lra.
Qed.
End Near.
End Vertex.

Lemma kernels_are_enough :
  (least_inflation <= inflation /\ least_size <= of_size /\ least_inverse <= of_inverse)%Q.
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
