(* SPDX-License-Identifier: MIT *)
(* eye_records.clh, set_eye_plane(): 1 / t of a triangle's plane at a position of the picture, against its margin.
     rounding         from the record's numbers: 8 u L, and 2^-108;
     products_near    N . r, from the rounded N and the dot products: 10.2 u Q_N;
     quotient_moves   what the errors of N . r and of D (det3_float.v) do to their quotient;
     margin_near      the margin itself, as it is computed.

   Assumed: C, S and T (corner, step_x, step_y) have met one rounding; (X, Y) lies in the picture, each 0 or from 2^-7 to
   2^14 (no side has more pixels); `largest` is at least |C| + |X| |S| + |Y| |T|; no difference and no coordinate of C, S and T
   exceeds 1048577 (the kernel compares what it computed with 2^20), and Q_N is 2^-40 at least; a quotient is off by 2.5 ulp
   and by 2^-126; D is off by less than a quarter of itself, as the level asks. Denormals may be kept or flushed; the margin
   has EYE_PLANE_NEAR for what that takes of 1 / t. The 1 % covers the margin's own roundings (planes.v). In prose: nearness()
   is off by u / 32, which 8 u L holds as well. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition a_x := 0%nat.
Definition a_y := 1%nat.
Definition a_z := 2%nat.
Definition b_x := 3%nat.
Definition b_y := 4%nat.
Definition b_z := 5%nat.
Definition c_x := 6%nat.
Definition c_y := 7%nat.
Definition c_z := 8%nat.
Definition eye_x := 9%nat.
Definition eye_y := 10%nat.
Definition eye_z := 11%nat.
Definition X := 12%nat.
Definition Y := 13%nat.
Definition width := 14%nat.
Definition height := 15%nat.
Definition largest_x := 16%nat.
Definition largest_y := 17%nat.
Definition largest_z := 18%nat.
Definition picture_0_0 := 19%nat.
Definition picture_0_1 := 20%nat.
Definition picture_0_2 := 21%nat.
Definition picture_1_0 := 22%nat.
Definition picture_1_1 := 23%nat.
Definition picture_1_2 := 24%nat.
Definition picture_2_0 := 25%nat.
Definition picture_2_1 := 26%nat.
Definition picture_2_2 := 27%nat.
Definition quotient_1 := 28%nat.
Definition quotient_2 := 29%nat.
Definition quotient_3 := 30%nat.
Definition quotient_4 := 31%nat.
Definition quotient_5 := 32%nat.
Definition quotient_1_over :=
  Add (Add (Mul (Given picture_1_0 1) (Sub (Mul (Diff b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z) (Diff c_y a_y))))
    (Mul (Given picture_1_1 1) (Sub (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff b_x a_x) (Diff c_z a_z))))) (Mul
    (Given picture_1_2 1) (Sub (Mul (Diff b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x)))).
Definition quotient_1_under :=
  Add (Add (Mul (Diff a_x eye_x) (Sub (Mul (Diff b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z) (Diff c_y a_y)))) (Mul
    (Diff a_y eye_y) (Sub (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff b_x a_x) (Diff c_z a_z))))) (Mul (Diff a_z
    eye_z) (Sub (Mul (Diff b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x)))).
Definition quotient_2_over :=
  Add (Add (Mul (Given picture_2_0 1) (Sub (Mul (Diff b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z) (Diff c_y a_y))))
    (Mul (Given picture_2_1 1) (Sub (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff b_x a_x) (Diff c_z a_z))))) (Mul
    (Given picture_2_2 1) (Sub (Mul (Diff b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x)))).
Definition quotient_2_under :=
  quotient_1_under.
Definition quotient_3_over :=
  Add (Add (Mul (Given picture_0_0 1) (Sub (Mul (Diff b_y a_y) (Diff c_z a_z)) (Mul (Diff b_z a_z) (Diff c_y a_y))))
    (Mul (Given picture_0_1 1) (Sub (Mul (Diff b_z a_z) (Diff c_x a_x)) (Mul (Diff b_x a_x) (Diff c_z a_z))))) (Mul
    (Given picture_0_2 1) (Sub (Mul (Diff b_x a_x) (Diff c_y a_y)) (Mul (Diff b_y a_y) (Diff c_x a_x)))).
Definition quotient_3_under :=
  quotient_2_under.
Definition z :=
  Fma (Given X 0) (Given quotient_1 5) (Fma (Given Y 0) (Given quotient_2 5) (Given quotient_3 5)).
Definition quotient_4_over :=
  Times (10695475 # 17592186044416) (Add (Add (Mul (Add (Abs (Mul (Diff b_x a_x) (Diff c_z a_z))) (Abs (Mul (Diff
    b_z a_z) (Diff c_x a_x)))) (Given largest_y 0)) (Mul (Add (Abs (Mul (Diff b_y a_y) (Diff c_z a_z))) (Abs (Mul
    (Diff b_z a_z) (Diff c_y a_y)))) (Given largest_x 0))) (Mul (Add (Abs (Mul (Diff b_x a_x) (Diff c_y a_y))) (Abs
    (Mul (Diff b_y a_y) (Diff c_x a_x)))) (Given largest_z 0))).
Definition quotient_4_under :=
  Abs quotient_3_under.
Definition quotient_5_over :=
  Times (8796093 # 17592186044416) (Add (Add (Mul (Abs (Diff a_x eye_x)) (Add (Abs (Mul (Diff b_y a_y) (Diff c_z
    a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_y a_y))))) (Mul (Abs (Diff a_y eye_y)) (Add (Abs (Mul (Diff b_x a_x)
    (Diff c_z a_z))) (Abs (Mul (Diff b_z a_z) (Diff c_x a_x)))))) (Mul (Abs (Diff a_z eye_z)) (Add (Abs (Mul (Diff
    b_x a_x) (Diff c_y a_y))) (Abs (Mul (Diff b_y a_y) (Diff c_x a_x)))))).
Definition quotient_5_under :=
  quotient_4_under.
(* margin: where add(7.888609052210118e-31, mul(add(add(quotient_4, mul(quotient_5, mul(add(add(add(abs(quotient_3),
   mul(abs(quotient_1), width)), mul(abs(quotient_2), height)), quotient_4), 1.340000033378601))),
   mul(add(add(abs(quotient_3), mul(abs(quotient_1), width)), mul(abs(quotient_2), height)), 4.76837158203125e-07)),
   1.0099999904632568)) < infinity *)
(* margin: where add(add(mul(add(abs(mul(sub(b_x, a_x), sub(c_z, a_z))), abs(mul(sub(b_z, a_z), sub(c_x, a_x)))),
   largest_y), mul(add(abs(mul(sub(b_y, a_y), sub(c_z, a_z))), abs(mul(sub(b_z, a_z), sub(c_y, a_y)))), largest_x)),
   mul(add(abs(mul(sub(b_x, a_x), sub(c_y, a_y))), abs(mul(sub(b_y, a_y), sub(c_x, a_x)))), largest_z)) >=
   9.094947017729282e-13 *)
(* margin: where max(abs(sub(b_z, a_z)), max(abs(sub(b_x, a_x)), abs(sub(b_y, a_y)))) <= 1048576.0 *)
(* margin: where max(abs(sub(c_z, a_z)), max(abs(sub(c_x, a_x)), abs(sub(c_y, a_y)))) <= 1048576.0 *)
(* margin: where mul(4.0, quotient_5_over) < quotient_5_under *)
Definition margin :=
  Add (Const (1 # 1267650600228229401496703205376)) (Times (4236247 # 4194304) (Add (Add (Given quotient_4 5) (Mul
    (Given quotient_5 5) (Times (11240735 # 8388608) (Add (Add (Add (Abs (Given quotient_3 5)) (Mul (Abs (Given
    quotient_1 5)) (Given width 0))) (Mul (Abs (Given quotient_2 5)) (Given height 0))) (Given quotient_4 5)))))
    (Times (1 # 2097152) (Add (Add (Abs (Given quotient_3 5)) (Mul (Abs (Given quotient_1 5)) (Given width 0))) (Mul
    (Abs (Given quotient_2 5)) (Given height 0)))))).
(* where add(add(mul(add(abs(mul(sub(b_x, a_x), sub(c_z, a_z))), abs(mul(sub(b_z, a_z), sub(c_x, a_x)))),
   largest_y), mul(add(abs(mul(sub(b_y, a_y), sub(c_z, a_z))), abs(mul(sub(b_z, a_z), sub(c_y, a_y)))), largest_x)),
   mul(add(abs(mul(sub(b_x, a_x), sub(c_y, a_y))), abs(mul(sub(b_y, a_y), sub(c_x, a_x)))), largest_z)) >=
   9.094947017729282e-13 *)
(* where mul(4.0, quotient_5_over) < quotient_5_under *)
(* where margin < infinity *)
(* where max(abs(sub(b_z, a_z)), max(abs(sub(b_x, a_x)), abs(sub(b_y, a_y)))) <= 1048576.0 *)
(* where max(abs(sub(c_z, a_z)), max(abs(sub(c_x, a_x)), abs(sub(c_y, a_y)))) <= 1048576.0 *)
(* where add(add(mul(abs(sub(a_x, eye_x)), add(abs(mul(sub(b_y, a_y), sub(c_z, a_z))), abs(mul(sub(b_z, a_z),
   sub(c_y, a_y))))), mul(abs(sub(a_y, eye_y)), add(abs(mul(sub(b_x, a_x), sub(c_z, a_z))), abs(mul(sub(b_z, a_z),
   sub(c_x, a_x)))))), mul(abs(sub(a_z, eye_z)), add(abs(mul(sub(b_x, a_x), sub(c_y, a_y))), abs(mul(sub(b_y, a_y),
   sub(c_x, a_x)))))) >= 9.094947017729282e-13 *)
(* where max(abs(sub(a_z, eye_z)), max(abs(sub(a_x, eye_x)), abs(sub(a_y, eye_y)))) <= 1048576.0 *)
(* end: from the kernels *)

Section Plane.
Variable x : nat -> R.
Open Scope R_scope.
Hypotheses (X_in : Rabs (x X) <= x width) (Y_in : Rabs (x Y) <= x height).

(* L: the sum of the magnitudes that the margin multiplies with its constant. *)
Definition of_largest := match margin with Add _ (Times _ (Add _ (Times c _))) => c | _ => 0%Q end.
Definition largest := match margin with Add _ (Times _ (Add _ (Times _ l))) => l | _ => Const 0 end.
Definition inflation := match margin with Add _ (Times i _) => i | _ => 0%Q end.
Definition times_error : Q := match margin with Add _ (Times _ (Add (Add _ (Mul _ (Times c _))) _)) => c | _ => 0%Q end.
Definition of_nothing : Q := match margin with Add (Const c) _ => c | _ => 0%Q end.
Lemma margin_is : margin = Add (Const of_nothing) (Times inflation
  (Add (Add (Given quotient_4 5) (Mul (Given quotient_5 5) (Times times_error (Add largest (Given quotient_4 5)))))
       (Times of_largest largest))).
Proof. reflexivity. Qed.
Definition constant : Q := of_largest * inflation * (1 - (4 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (rate u32Q z largest / (inflation * (1 - (4 # 2 ^ 24))))%Q.

(* A place is no denormal, so that no device flushes it. *)
Definition is_place i := (Nat.eqb i X || Nat.eqb i Y || Nat.eqb i width || Nat.eqb i height)%bool.
Definition may_lose i := if is_place i then 0%Q else h32Q.
Let place i := x i = 0 \/ / 128 <= x i <= 16384.
Hypotheses (place_X : place X) (place_Y : place Y) (place_width : place width) (place_height : place height).
Lemma kept : keeps x may_lose.
Proof.
  intros i. assert (h := h32_below). simpl in h. unfold may_lose, is_place.
  assert (P : forall j, place j -> x j = 0 \/ 2 * h32 <= Rabs (x j)).
  { intros j [Z | Z]; [now left | right]. rewrite Rabs_pos_eq; lra. }
  destruct (Nat.eqb_spec i X) as [-> |]; [right; split; auto |].
  destruct (Nat.eqb_spec i Y) as [-> |]; [right; split; auto |].
  destruct (Nat.eqb_spec i width) as [-> |]; [right; split; auto |].
  destruct (Nat.eqb_spec i height) as [-> |]; [right; split; auto | now left].
Qed.
Definition at_most i : Q := if is_place i then 16384 else any.
Definition rest_of_z : Q := 1 # 324518553658426726783156020576256.  (* 2^-108 *)
Theorem rounding v s :
  within x (fun i => Q2R (at_most i)) (fun i j => Q2R (apart any i j)) z ->
  within x (fun i => Q2R (at_most i)) (fun i j => Q2R (apart any i j)) largest ->
  computes32 x z v -> computes32 x largest s -> 0 <= s -> Rabs (v - real x z) <= Q2R constant * s + Q2R rest_of_z.
Proof.
  assert (X0 := Rabs_pos (x X)). assert (Y0 := Rabs_pos (x Y)).
  assert (W := Rabs_pos_eq (x width) ltac:(lra)). assert (H := Rabs_pos_eq (x height) ltac:(lra)).
  intros. eapply float_error with (size := largest) (f := may_lose) (m := at_most) (d := apart any); try eassumption; try
    exact kept.
  - vm_compute. reflexivity.
  - cbv [z largest margin permanent]. rewrite W, H.
    assert (G1 := Rmult_le_compat_r _ _ _ (Rabs_pos (x quotient_1)) X_in).
    assert (G2 := Rmult_le_compat_r _ _ _ (Rabs_pos (x quotient_2)) Y_in). lra.
  - cbv [largest margin real permanent]. rewrite W, H. reflexivity.
Qed.
(* The record's numbers are off by 2^-126 from quotients, as underflow may have it: so much more is 1 / t. *)
Lemma of_quotients a b c : Rabs (x quotient_1 - a) <= h32 -> Rabs (x quotient_2 - b) <= h32 -> Rabs (x quotient_3 - c) <= h32
  -> Rabs (real x z - (x X * a + x Y * b + c)) <= Q2R rest_of_z.
Proof.
  intros A B C. replace (Q2R rest_of_z) with (/ 324518553658426726783156020576256) by (unfold Q2R, rest_of_z; simpl; lra).
  assert (h := h32_below). simpl in h. cbn. assert (h0 := h32_positive).
  assert (P : forall i, place i -> Rabs (x i) <= 16384) by (intros i [-> | ?]; [rewrite Rabs_R0 | rewrite Rabs_pos_eq]; lra).
  assert (PA := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) (P _ place_X) A).
  assert (PB := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) (P _ place_Y) B). rewrite <- Rabs_mult in PA, PB.
  replace (x X * x quotient_1 + (x Y * x quotient_2 + x quotient_3) - (x X * a + x Y * b + c)) with
    (x X * (x quotient_1 - a) + (x Y * (x quotient_2 - b) + (x quotient_3 - c))) by ring.
  apply between in PA, PB, C. apply Rabs_le. lra.
Qed.

(* L is the greatest of the record's numbers here; quotient_5 is below 1/4, as D is certain to a quarter. *)
Definition sizes_in_margin i : polynomial :=
  if is_place i then number 16384 else if Nat.eqb i quotient_5 then number 1 else line 0 1.
Theorem margin_near L v : 0 <= L -> within x (fun i => at_size L (sizes_in_margin i)) (fun _ _ => 0) margin ->
  computes32 x margin v -> Rabs (v - real x margin) <= alpha u32 (roundings margin) * permanent x margin +
    at_size L (line (1 # 2 ^ 104) (1 # 2 ^ 60)).
Proof.
  intros L0 W C. exact (near_at_size_keeping x may_lose sizes_in_margin (fun _ _ => nil) L (line (1 # 2 ^ 104) (1 # 2 ^ 60))
    margin v kept L0 ltac:(vm_compute; reflexivity) W C).
Qed.

(* ---- N . r ---- *)
Let large c i j k := Rabs (x i) + Rabs (x X) * Rabs (x j) + Rabs (x Y) * Rabs (x k) <= x c.
Hypotheses (large_x : large largest_x picture_0_0 picture_1_0 picture_2_0).
Hypotheses (large_y : large largest_y picture_0_1 picture_1_1 picture_2_1).
Hypotheses (large_z : large largest_z picture_0_2 picture_1_2 picture_2_2).
Definition of_products := match quotient_4_over with Times c _ => c | _ => 0%Q end.
Definition products := match quotient_4_over with Times _ s => s | _ => Const 0 end.
Definition least_products : Q := 91 # 167772160.
Definition rest_of_products : Q := 1 # 604462909807314587353088.  (* 2^-79 *)
Definition right e v := limited32 1048577 x e v.

Theorem products_near p_x p_y p_0 :
  right quotient_1_over p_x -> right quotient_2_over p_y -> right quotient_3_over p_0 ->
  / 1100000000000 <= real x products ->
  Rabs ((p_x * x X + p_y * x Y + p_0) -
        (real x quotient_1_over * x X + real x quotient_2_over * x Y + real x quotient_3_over)) <=
  Q2R least_products * real x products.
Proof.
  intros N1 N2 N3 Q_least. unfold right in *.
  near_in 1048577%Q rest_of_products quotient_1_over N1. near_in 1048577%Q rest_of_products quotient_2_over N2.
  near_in 1048577%Q rest_of_products quotient_3_over N3.
  replace (Q2R rest_of_products) with (/ 604462909807314587353088) in * by (unfold Q2R, rest_of_products; simpl; lra).
  assert (P : forall i, place i -> Rabs (x i) <= 16384) by (intros i [-> | ?]; [rewrite Rabs_R0 | rewrite Rabs_pos_eq]; lra).
  assert (PX := P _ place_X). assert (PY := P _ place_Y). clear P.
  replace (p_x * x X + p_y * x Y + p_0 - (real x quotient_1_over * x X + real x quotient_2_over * x Y +
    real x quotient_3_over)) with ((p_x - real x quotient_1_over) * x X + ((p_y - real x quotient_2_over) * x Y +
    (p_0 - real x quotient_3_over))) by ring.
  assert (M1 := Rmult_le_compat_r _ _ _ (Rabs_pos (x X)) N1). assert (M2 := Rmult_le_compat_r _ _ _ (Rabs_pos (x Y))
    N2).
  rewrite <- Rabs_mult in M1, M2.
  assert (T1 := Rabs_triang ((p_x - real x quotient_1_over) * x X) ((p_y - real x quotient_2_over) * x Y +
    (p_0 - real x quotient_3_over))).
  assert (T2 := Rabs_triang ((p_y - real x quotient_2_over) * x Y) (p_0 - real x quotient_3_over)).
  set (T := permanent x quotient_1_over * Rabs (x X) + (permanent x quotient_2_over * Rabs (x Y) +
    permanent x quotient_3_over)).
  assert (E : Rabs ((p_x - real x quotient_1_over) * x X + ((p_y - real x quotient_2_over) * x Y +
    (p_0 - real x quotient_3_over))) <= alpha u32 8 * T + 32769 * / 604462909807314587353088).
  { unfold T. change (roundings quotient_1_over) with 8%nat in M1. change (roundings quotient_2_over) with 8%nat in M2.
    change (roundings quotient_3_over) with 8%nat in N3. lra. }
  assert (T0 : 0 <= T).
  { unfold T. assert (P := permanent_positive x). assert (P1 := Rmult_le_pos _ _ (P quotient_1_over) (Rabs_pos (x X))).
    assert (P2 := Rmult_le_pos _ _ (P quotient_2_over) (Rabs_pos (x Y))). specialize (P quotient_3_over). lra. }
  assert (A := alpha_below 8 ltac:(lia)). simpl INR in A.
  assert (S : T <= real x products).
  { unfold T. cbv [products quotient_4_over quotient_1_over quotient_2_over quotient_3_over real permanent].
    rewrite !Rabs_mult. unfold large in *.
    set (m1 := Rabs (x b_y - x a_y) * Rabs (x c_z - x a_z)). set (m2 := Rabs (x b_z - x a_z) * Rabs (x c_y - x a_y)).
    set (m3 := Rabs (x b_z - x a_z) * Rabs (x c_x - x a_x)). set (m4 := Rabs (x b_x - x a_x) * Rabs (x c_z - x a_z)).
    set (m5 := Rabs (x b_x - x a_x) * Rabs (x c_y - x a_y)). set (m6 := Rabs (x b_y - x a_y) * Rabs (x c_x - x a_x)).
    assert (P : forall i j k l, 0 <= Rabs (x i - x j) * Rabs (x k - x l)) by (intros; apply Rmult_le_pos; apply
      Rabs_pos).
    assert (Q1 : 0 <= m1 + m2) by (apply Rplus_le_le_0_compat; apply P).
    assert (Q2 : 0 <= m3 + m4) by (apply Rplus_le_le_0_compat; apply P).
    assert (Q3 : 0 <= m5 + m6) by (apply Rplus_le_le_0_compat; apply P).
    assert (G1 := Rmult_le_compat_l _ _ _ Q1 large_x). assert (G2 := Rmult_le_compat_l _ _ _ Q2 large_y).
    assert (G3 := Rmult_le_compat_l _ _ _ Q3 large_z). lra. }
  assert (F := Rmult_le_compat _ _ _ _ (alpha_at_least 8) T0 A S).
  replace (Q2R least_products) with (91 / 10 * / 16777216) by (unfold Q2R, least_products; simpl; lra). lra.
Qed.
End Plane.

(* Z = m_p / E, the real 1 / t; n_p and D are the computed N . r and determinant, n_p / D is at most L. *)
Open Scope R_scope.
Theorem quotient_moves n_p m_p D E d_p d_D L :
  Rabs (m_p - n_p) <= d_p -> Rabs (E - D) <= d_D -> Rabs (n_p / D) <= L -> 4 * d_D < Rabs D ->
  Rabs (m_p / E - n_p / D) <= d_p / Rabs D + 4 / 3 * (L + d_p / Rabs D) * (d_D / Rabs D).
Proof.
  intros Hp HD HL steep. assert (dD0 := Rle_trans _ _ _ (Rabs_pos _) HD). assert (dp0 := Rle_trans _ _ _ (Rabs_pos _)
    Hp).
  assert (D0 : D <> 0) by (intros ->; rewrite Rabs_R0 in steep; lra). assert (s0 := Rabs_pos_lt _ D0).
  assert (least : 3 / 4 * Rabs D <= Rabs E).
  { assert (T := Rabs_triang_inv D (D - E)). replace (D - (D - E)) with E in T by ring. rewrite Rabs_minus_sym in HD.
    lra. }
  assert (E0 : E <> 0) by (intros ->; rewrite Rabs_R0 in least; lra).
  assert (I : 0 <= / Rabs D) by (left; apply Rinv_0_lt_compat, s0).
  replace (m_p / E - n_p / D) with ((m_p - n_p) * / D + - (m_p / E * ((E - D) * / D))) by (field; auto).
  eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, !Rabs_mult, Rabs_inv. unfold Rdiv.
  assert (Z : Rabs (m_p * / E) <= 4 / 3 * (L + d_p * / Rabs D)).
  { replace (m_p * / E) with ((n_p / D + (m_p - n_p) * / D) * (D * / E)) by (field; auto). rewrite Rabs_mult.
    rewrite (Rmult_comm (4 / 3)). apply Rmult_le_compat; auto using Rabs_pos.
    - eapply Rle_trans; [apply Rabs_triang |]. rewrite (Rabs_mult (m_p - n_p)), Rabs_inv.
      assert (G := Rmult_le_compat_r _ _ _ I Hp). lra.
    - rewrite Rabs_mult, Rabs_inv. assert (e0 := Rabs_pos_lt _ E0). apply Rmult_le_reg_r with (Rabs E); auto.
      rewrite Rmult_assoc, Rinv_l by lra. lra. }
  assert (G1 := Rmult_le_compat_r _ _ _ I Hp). assert (G2 := Rmult_le_compat_r _ _ _ I HD).
  assert (Z0 := Rabs_pos (m_p * / E)).
  assert (G0 : 0 <= Rabs (E - D) * / Rabs D) by (apply Rmult_le_pos; auto using Rabs_pos).
  assert (G3 := Rmult_le_compat _ _ _ _ Z0 G0 Z G2). lra.
Qed.
Lemma kernel_is_enough : (4 # 3 <= times_error /\ 2 * rest_of_z + (1 # 2 ^ 103) <= of_nothing)%Q.
Proof. vm_compute. split; discriminate. Qed.

Definition constants := Eval vm_compute in shown least_bound of_largest.
Print constants.
Definition rests := Eval vm_compute in shown least_products of_products.
Print rests.
Definition checked := (rounding, of_quotients, margin_near, products_near, quotient_moves, kernel_is_enough).
Print Assumptions checked.
