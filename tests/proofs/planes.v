(* SPDX-License-Identifier: MIT *)
(* triangle_records.clh, set_plane_parallel(): how far a plane's height at a point of the grid may be from the real plane's at
   the real point (docs/numerics.md, 4):
     rounding, of_quotients  the computed height, from the record's numbers: 20 u L, and what underflow takes;
     n_x_near and so on      the normal: delta_x, delta_y, delta_z;
     plane_moves             what errors of normal, corner and point do to the height: the margin's quotient and error_z;
     quotient_is_enough      that quotient as it is computed, by over_least and under_most, times 1.0085;
     plane_is_near           these three together, of any computed n;
     margin_near             the margin, from its quotients.
   height_error on top is the point's own.

   Assumed: x and y of corners are off by at most `error`, from 2^-24 on, z by error_z, from 2^-90 on (projection.v); |X|, |Y|,
   |a_x| and |a_y| are at most what L multiplies the slopes with, which is from 1 (a bin has a texel) to 2^40 (vertices from
   1e12 on are out of range); largest_offset(), greater_3, is half a texel at least (edge_functions.v, rho_has, with W = 1); a
   quotient is off by 2.5 ulp and by 2^-126, as a slope is; safe_n_z is more than a quarter of |n_z|, which the kernel asks,
   here a fifth. N, the computed n, is one float wherever it is used. Denormals may be kept or flushed: what that takes of the
   normal is less than 2^-8 of the delta, of the quotient's sums a third of a hundredth, of the rest it is in PLANE_NEAR.
   Overflow: no height is certain where the margin is infinite. *)
From Coq Require Import Reals QArith Qreals Lra Lia Psatz.
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
Definition X := 9%nat.
Definition Y := 10%nat.
Definition reach := 11%nat.
Definition error := 12%nat.
Definition error_z := 13%nat.
Definition point_error := 14%nat.
Definition height_error := 15%nat.
Definition orientation := 16%nat.
Definition quotient_1 := 17%nat.
Definition quotient_2 := 18%nat.
Definition greater_1 := 19%nat.
Definition greater_2 := 20%nat.
Definition greater_3 := 21%nat.
Definition quotient_3 := 22%nat.
Definition quotient_4 := 23%nat.
Definition greater_4 := 24%nat.
Definition greater_5 := 25%nat.
Definition quotient_1_over :=
  Neg (Fma (Diff b_y a_y) (Diff c_z a_z) (Mul (Neg (Diff b_z a_z)) (Diff c_y a_y))).
Definition quotient_1_under :=
  Fma (Diff b_x a_x) (Diff c_y a_y) (Mul (Neg (Diff b_y a_y)) (Diff c_x a_x)).
Definition plane_x := Given quotient_1 5.
Definition quotient_2_over :=
  Neg (Fma (Diff b_z a_z) (Diff c_x a_x) (Mul (Neg (Diff b_x a_x)) (Diff c_z a_z))).
Definition quotient_2_under :=
  quotient_1_under.
Definition plane_y := Given quotient_2 5.
Definition plane_0 :=
  Sub (Given a_z 0) (Add (Mul (Given quotient_1 5) (Given a_x 0)) (Mul (Given quotient_2 5) (Given a_y 0))).
Definition height :=
  Fma (Given X 0) (Given quotient_1 5) (Fma (Given Y 0) (Given quotient_2 5) plane_0).
Definition greater_1_one :=
  Abs (Given a_x 0).
Definition greater_1_other :=
  Abs (Diff a_x reach).
Definition greater_2_one :=
  Abs (Given a_y 0).
Definition greater_2_other :=
  Abs (Diff a_y reach).
Definition greater_3_one := Given greater_1 0.
Definition greater_3_other := Given greater_2 0.
Definition quotient_3_over :=
  Mul (Add (Abs (Fma (Diff b_y a_y) (Diff c_z a_z) (Mul (Neg (Diff b_z a_z)) (Diff c_y a_y)))) (Abs (Fma (Diff b_z
    a_z) (Diff c_x a_x) (Mul (Neg (Diff b_x a_x)) (Diff c_z a_z))))) (Add (Add (Given error 0) (Given greater_3 0))
    (Given point_error 0)).
Definition quotient_3_under :=
  Sub (Abs quotient_2_under) (Times (4236247 # 4194304) (Add (Add (Add (Add (Add (Mul (Abs (Diff b_x a_x)) (Add
    (Given error 0) (Given error 0))) (Mul (Abs (Diff c_y a_y)) (Add (Given error 0) (Given error 0)))) (Mul (Abs
    (Diff b_y a_y)) (Add (Given error 0) (Given error 0)))) (Mul (Abs (Diff c_x a_x)) (Add (Given error 0) (Given
    error 0)))) (Times (2 # 1) (Mul (Add (Given error 0) (Given error 0)) (Add (Given error 0) (Given error 0)))))
    (Times (1 # 4194304) (Add (Mul (Abs (Diff b_x a_x)) (Abs (Diff c_y a_y))) (Mul (Abs (Diff b_y a_y)) (Abs (Diff
    c_x a_x))))))).
Definition quotient_4_over :=
  Add (Add (Add (Mul (Add (Add (Add (Add (Add (Add (Mul (Abs (Diff b_y a_y)) (Add (Given error_z 0) (Given error_z
    0))) (Mul (Abs (Diff c_z a_z)) (Add (Given error 0) (Given error 0)))) (Mul (Abs (Diff b_z a_z)) (Add (Given
    error 0) (Given error 0)))) (Mul (Abs (Diff c_y a_y)) (Add (Given error_z 0) (Given error_z 0)))) (Mul (Add
    (Given error 0) (Given error 0)) (Add (Given error_z 0) (Given error_z 0)))) (Mul (Add (Given error 0) (Given
    error 0)) (Add (Given error_z 0) (Given error_z 0)))) (Times (1 # 4194304) (Add (Mul (Abs (Diff b_y a_y)) (Abs
    (Diff c_z a_z))) (Mul (Abs (Diff b_z a_z)) (Abs (Diff c_y a_y)))))) (Add (Add (Given error 0) (Given greater_3
    0)) (Given point_error 0))) (Mul (Add (Add (Add (Add (Add (Add (Mul (Abs (Diff b_z a_z)) (Add (Given error 0)
    (Given error 0))) (Mul (Abs (Diff c_x a_x)) (Add (Given error_z 0) (Given error_z 0)))) (Mul (Abs (Diff b_x
    a_x)) (Add (Given error_z 0) (Given error_z 0)))) (Mul (Abs (Diff c_z a_z)) (Add (Given error 0) (Given error
    0)))) (Mul (Add (Given error 0) (Given error 0)) (Add (Given error_z 0) (Given error_z 0)))) (Mul (Add (Given
    error 0) (Given error 0)) (Add (Given error_z 0) (Given error_z 0)))) (Times (1 # 4194304) (Add (Mul (Abs (Diff
    b_x a_x)) (Abs (Diff c_z a_z))) (Mul (Abs (Diff b_z a_z)) (Abs (Diff c_x a_x)))))) (Add (Add (Given error 0)
    (Given greater_3 0)) (Given point_error 0)))) (Mul (Add (Add (Add (Add (Add (Mul (Abs (Diff b_x a_x)) (Add
    (Given error 0) (Given error 0))) (Mul (Abs (Diff c_y a_y)) (Add (Given error 0) (Given error 0)))) (Mul (Abs
    (Diff b_y a_y)) (Add (Given error 0) (Given error 0)))) (Mul (Abs (Diff c_x a_x)) (Add (Given error 0) (Given
    error 0)))) (Times (2 # 1) (Mul (Add (Given error 0) (Given error 0)) (Add (Given error 0) (Given error 0)))))
    (Times (1 # 4194304) (Add (Mul (Abs (Diff b_x a_x)) (Abs (Diff c_y a_y))) (Mul (Abs (Diff b_y a_y)) (Abs (Diff
    c_x a_x)))))) (Given quotient_3 5))) (Mul (Add (Abs (Fma (Diff b_y a_y) (Diff c_z a_z) (Mul (Neg (Diff b_z a_z))
    (Diff c_y a_y)))) (Abs (Fma (Diff b_z a_z) (Diff c_x a_x) (Mul (Neg (Diff b_x a_x)) (Diff c_z a_z))))) (Add
    (Given error 0) (Given point_error 0))).
Definition quotient_4_under :=
  quotient_3_under.
Definition greater_4_one :=
  greater_1_one.
Definition greater_4_other := Given reach 0.
Definition greater_5_one :=
  greater_2_one.
Definition greater_5_other := Given reach 0.
(* margin: where add(8.271806125530277e-25, mul(add(add(add(quotient_4, error_z), height_error), mul(add(abs(a_z),
   add(mul(abs(quotient_1), greater_4), mul(abs(quotient_2), greater_5))), 1.1920928955078125e-06)),
   1.0099999904632568)) < infinity *)
(* margin: where mul(quotient_2_under, orientation) > 0.0 *)
(* margin: where quotient_4_under > mul(abs(quotient_2_under), 0.25) *)
Definition margin :=
  Add (Const (1 # 1208925819614629174706176)) (Times (4236247 # 4194304) (Add (Add (Add (Given quotient_4 5) (Given
    error_z 0)) (Given height_error 0)) (Times (5 # 4194304) (Add (Abs (Given a_z 0)) (Add (Mul (Abs (Given
    quotient_1 5)) (Given greater_4 0)) (Mul (Abs (Given quotient_2 5)) (Given greater_5 0))))))).
(* where mul(quotient_2_under, orientation) > 0.0 *)
(* where quotient_4_under > mul(abs(quotient_2_under), 0.25) *)
(* where margin < infinity *)
(* end: from the kernels *)

(* The heights of two planes: z through `a` with the normal n, as they are computed, and Z through A with the normal
  m, the
   real one, at points whose places relative to a and A, (P, Q) and (X, Y), are within E. *)
Section Moved.
Open Scope R_scope.
Variables n_x n_y n_z m_x m_y m_z d_x d_y d_z P Q X Y a A rho E e : R.
Hypotheses (near_x : Rabs (m_x - n_x) <= d_x) (near_y : Rabs (m_y - n_y) <= d_y) (near_z : Rabs (m_z - n_z) <= d_z).
Hypotheses (X_in : Rabs X <= rho) (Y_in : Rabs Y <= rho) (P_in : Rabs P <= rho) (Q_in : Rabs Q <= rho).
Hypotheses (X_near : Rabs (X - P) <= E) (Y_near : Rabs (Y - Q) <= E) (A_near : Rabs (A - a) <= e).
Hypothesis steep : d_z < Rabs n_z.

Theorem plane_moves :
  Rabs ((A - (m_x * X + m_y * Y) / m_z) - (a + (- n_x / n_z * P + - n_y / n_z * Q))) <=
  (d_x * rho + d_y * rho + d_z * ((Rabs n_x + Rabs n_y) * rho / Rabs n_z) + (Rabs n_x + Rabs n_y) * E) /
  (Rabs n_z - d_z) + e.
Proof.
  assert (nonzero : n_z <> 0) by (intros ->; rewrite Rabs_R0 in steep; assert (S := Rabs_pos (m_z - 0)); lra).
  assert (least : Rabs n_z - d_z <= Rabs m_z).
  { assert (T := Rabs_triang_inv n_z (n_z - m_z)). replace (n_z - (n_z - m_z)) with m_z in T by ring.
    rewrite Rabs_minus_sym in near_z. lra. }
  assert (M : m_z <> 0) by (intros ->; rewrite Rabs_R0 in least; lra).
  set (T := (n_x * P + n_y * Q) / n_z).
  set (K := (m_x - n_x) * X + ((m_y - n_y) * Y + ((n_x * (X - P) + n_y * (Y - Q)) + - ((m_z - n_z) * T)))).
  replace ((A - (m_x * X + m_y * Y) / m_z) - (a + (- n_x / n_z * P + - n_y / n_z * Q))) with (- (K * / m_z) + (A - a))
    by (unfold K, T; field; auto).
  eapply Rle_trans; [apply Rabs_triang |]. apply Rplus_le_compat; [| assumption].
  rewrite Rabs_Ropp, Rabs_mult, Rabs_inv. unfold Rdiv.
  assert (times : forall p q r s, Rabs p <= r -> Rabs q <= s -> Rabs (p * q) <= r * s).
  { intros. rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos. }
  assert (T_in : Rabs T <= (Rabs n_x + Rabs n_y) * rho * / Rabs n_z).
  { unfold T, Rdiv. rewrite Rabs_mult, Rabs_inv. apply Rmult_le_compat_r.
    - left. apply Rinv_0_lt_compat, Rabs_pos_lt, nonzero.
    - eapply Rle_trans; [apply Rabs_triang |].
      assert (G1 := times _ _ _ _ (Rle_refl (Rabs n_x)) P_in). assert (G2 := times _ _ _ _ (Rle_refl (Rabs n_y))
        Q_in). lra. }
  apply Rmult_le_compat; auto using Rabs_pos.
  - left. apply Rinv_0_lt_compat, Rabs_pos_lt, M.
  - unfold K.
    assert (T1 := Rabs_triang ((m_x - n_x) * X) ((m_y - n_y) * Y + ((n_x * (X - P) + n_y * (Y - Q)) + - ((m_z - n_z) *
      T)))).
    assert (T2 := Rabs_triang ((m_y - n_y) * Y) ((n_x * (X - P) + n_y * (Y - Q)) + - ((m_z - n_z) * T))).
    assert (T3 := Rabs_triang (n_x * (X - P) + n_y * (Y - Q)) (- ((m_z - n_z) * T))). rewrite Rabs_Ropp in T3.
    assert (T4 := Rabs_triang (n_x * (X - P)) (n_y * (Y - Q))).
    assert (G1 := times _ _ _ _ near_x X_in). assert (G2 := times _ _ _ _ near_y Y_in).
    assert (G3 := times _ _ _ _ near_z T_in). assert (G4 := times _ _ _ _ (Rle_refl (Rabs n_x)) X_near).
    assert (G5 := times _ _ _ _ (Rle_refl (Rabs n_y)) Y_near). lra.
  - apply Rinv_le_contravar; lra.
Qed.
End Moved.

Section Plane.
Variable x : nat -> R.
Open Scope R_scope.

(* ---- The height's roundings ---- *)
Hypotheses (a_x_in : Rabs (x a_x) <= x greater_4) (a_y_in : Rabs (x a_y) <= x greater_5).
Hypotheses (X_in : Rabs (x X) <= x greater_4) (Y_in : Rabs (x Y) <= x greater_5).

Lemma height_is_the_planes :
  real x height = x a_z + x quotient_1 * (x X - x a_x) + x quotient_2 * (x Y - x a_y).
Proof. cbv [height plane_0 real]. ring. Qed.

(* The grid has at most 2^14 texels a side; vertices from 1e12 on are out of range. *)
Hypotheses (greater_4_in : 1 <= x greater_4 <= 2 ^ 40) (greater_5_in : 1 <= x greater_5 <= 2 ^ 40).
(* L: the sum of the magnitudes that the margin multiplies with its constant. *)
Definition of_largest := match margin with Add _ (Times _ (Add _ (Times c _))) => c | _ => 0%Q end.
Definition largest := match margin with Add _ (Times _ (Add _ (Times _ l))) => l | _ => Const 0 end.
Definition inflation := match margin with Add _ (Times i _) => i | _ => 0%Q end.
Definition of_nothing : Q := match margin with Add (Const c) _ => c | _ => 0%Q end.
Lemma margin_is : margin = Add (Const of_nothing) (Times inflation
  (Add (Add (Add (Given quotient_4 5) (Given error_z 0)) (Given height_error 0)) (Times of_largest largest))).
Proof. reflexivity. Qed.
Definition twice := Times 2 largest.
(* The margin rounds six times more than `largest`, and once less than `twice`. *)
Definition constant : Q := of_largest * inflation * (1 # 2) * (1 - (7 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (2 * rate u32Q height twice / (inflation * (1 - (7 # 2 ^ 24))))%Q.

Lemma products : permanent x height <= permanent x twice.
Proof.
  assert (X0 := Rabs_pos (x X)). assert (Y0 := Rabs_pos (x Y)).
  assert (G4 := Rabs_pos_eq (x greater_4) ltac:(lra)). assert (G5 := Rabs_pos_eq (x greater_5) ltac:(lra)).
  assert (two : Rabs (Q2R 2) = 2) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  cbv [height plane_0 twice largest margin permanent]. rewrite two, G4, G5.
  assert (S1 := Rabs_pos (x quotient_1)). assert (S2 := Rabs_pos (x quotient_2)). assert (Z := Rabs_pos (x a_z)).
  assert (P1 := Rmult_le_compat_l _ _ _ S1 a_x_in). assert (P2 := Rmult_le_compat_l _ _ _ S2 a_y_in).
  assert (P3 := Rmult_le_compat_l _ _ _ S1 X_in). assert (P4 := Rmult_le_compat_l _ _ _ S2 Y_in). lra.
Qed.

(* What underflow takes: coordinates are up to 2^40, slopes and heights up to L, as both maxima are 1 at least. *)
Let L := real x largest.
Definition is_place i := (Nat.eqb i X || Nat.eqb i Y || Nat.eqb i a_x || Nat.eqb i a_y || Nat.eqb i greater_4 ||
  Nat.eqb i greater_5)%bool.
Definition sizes i : polynomial := if is_place i then number (2 ^ 40) else line 0 1.
Definition rest_of_height := line (1 # 2 ^ 82) (1 # 2 ^ 120).
Lemma inputs_in : Rabs (x a_z) <= L /\ Rabs (x quotient_1) <= L /\ Rabs (x quotient_2) <= L.
Proof.
  unfold L. cbv [largest margin real]. assert (S1 := Rabs_pos (x quotient_1)). assert (S2 := Rabs_pos (x quotient_2)).
  assert (Z := Rabs_pos (x a_z)). assert (P1 := Rmult_le_compat_l _ _ _ S1 (proj1 greater_4_in)).
  assert (P2 := Rmult_le_compat_l _ _ _ S2 (proj1 greater_5_in)). lra.
Qed.
Lemma power_40 : Q2R (2 ^ 40) = 2 ^ 40.
Proof. unfold Q2R. simpl. lra. Qed.
Theorem rounding v s : computes32 x height v -> computes32 x twice s ->
  Rabs (v - real x height) <= Q2R constant * s + at_size L rest_of_height.
Proof.
  assert (X0 := Rabs_pos (x X)). assert (Y0 := Rabs_pos (x Y)).
  assert (G4 := Rabs_pos_eq (x greater_4) ltac:(lra)). assert (G5 := Rabs_pos_eq (x greater_5) ltac:(lra)).
  assert (two : Rabs (Q2R 2) = Q2R 2) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  intros Cv Cs. destruct inputs_in as (I1 & I2 & I3). assert (L0 : 0 <= L) by (assert (Z := Rabs_pos (x a_z)); lra).
  clearbody L. assert (E := error_but_taken x (all h32Q) height twice constant v s (all_may_lose x) ltac:(vm_compute; reflexivity)
    ltac:(vm_compute; reflexivity) products ltac:(cbv [twice largest margin real permanent]; rewrite two, G4, G5;
      reflexivity) Cv Cs).
  assert (T1 := lost_is_at_most x (all h32Q) sizes (fun _ _ => nil) L (line (1 # 2 ^ 83) (1 # 2 ^ 121)) height
    (all_may_lose x) L0 ltac:(cbn -[Q2R Rabs pow Qpower]; rewrite ?Q2R_0', ?Q2R_1, ?power_40; repeat split; lra)
    ltac:(vm_compute; reflexivity)).
  assert (T2 := lost_is_at_most x (all h32Q) sizes (fun _ _ => nil) L (line (1 # 2 ^ 82) (1 # 2 ^ 120)) twice
    (all_may_lose x) L0 ltac:(cbn -[Q2R Rabs pow Qpower]; rewrite ?Q2R_0', ?Q2R_1, ?power_40, ?G4, ?G5; repeat split; lra)
    ltac:(vm_compute; reflexivity)).
  fold (taken x (all h32Q) height) in T1. fold (taken x (all h32Q) twice) in T2.
  assert (c : 0 <= Q2R constant <= / 2).
  { split; [rewrite <- Q2R_0' | replace (/ 2) with (Q2R (1 # 2)) by (unfold Q2R; simpl; lra)]; apply Qle_Rle;
    apply Qle_bool_iff; vm_compute; reflexivity. }
  assert (T0 : 0 <= taken x (all h32Q) twice)
    by (apply lost_positive; [apply bpow_ge_0 | apply bpow_ge_0 | exact (keeps_range x _ (all_may_lose x))]).
  assert (cT := Rmult_le_compat_r _ _ _ T0 (proj2 c)).
  set (k := Q2R constant) in *. clearbody k. unfold rest_of_height. revert T1 T2.
  cbn -[taken Q2R height twice]. unfold Q2R. simpl Qnum. simpl Qden. intros. lra.
Qed.
(* The slopes are off by 2^-126 from quotients, as underflow may have it: so much more is a height. *)
Lemma of_quotients p q : Rabs (x quotient_1 - p) <= h32 -> Rabs (x quotient_2 - q) <= h32 ->
  Rabs (real x height - (x a_z + p * (x X - x a_x) + q * (x Y - x a_y))) <= / 2 ^ 84.
Proof.
  intros A B. rewrite height_is_the_planes. assert (h1 := h32_below). assert (h0 := h32_positive).
  assert (far : forall i j g, Rabs (x i) <= x g -> Rabs (x j) <= x g -> x g <= 2 ^ 40 -> Rabs (x i - x j) <= 2 ^ 41).
  { intros i j g H1 H2 H3. apply between in H1, H2. apply Rabs_le. simpl in *. lra. }
  assert (PA := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) A (far X a_x greater_4 X_in a_x_in (proj2 greater_4_in))).
  assert (PB := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) B (far Y a_y greater_5 Y_in a_y_in (proj2 greater_5_in))).
  rewrite <- Rabs_mult in PA, PB. apply between in PA, PB. apply Rabs_le. simpl in *. lra.
Qed.

(* The margin as it is computed: M is the greatest of the quotient, the errors, the slopes and the height of a. *)
Theorem margin_near M v : 0 <= M -> within x (fun i => at_size M (sizes i)) (fun _ _ => 0) margin ->
  computes32 x margin v -> Rabs (v - real x margin) <= alpha u32 (roundings margin) * permanent x margin +
    at_size M (line (1 # 2 ^ 96) (1 # 2 ^ 100)).
Proof.
  intros M0 W C. exact (near_at_size x sizes (fun _ _ => nil) M (line (1 # 2 ^ 96) (1 # 2 ^ 100)) margin v M0
    ltac:(vm_compute; reflexivity) W C).
Qed.

(* ---- The normal, and how far the heights move with it ---- *)
Definition delta_x := match quotient_4_over with Add (Add (Add (Mul d _) _) _) _ => d | _ => Const 0 end.
Definition delta_y := match quotient_4_over with Add (Add (Add _ (Mul d _)) _) _ => d | _ => Const 0 end.
Definition delta_z := match quotient_4_over with Add (Add _ (Mul d _)) _ => d | _ => Const 0 end.
Definition n_x := match quotient_1_over with Neg n => n | _ => Const 0 end.
Definition n_y := match quotient_2_over with Neg n => n | _ => Const 0 end.
Definition n_z := quotient_1_under.

(* The real sides, (x1, y1, z1) and (x2, y2, z2), whose corners are off by `error` and `error_z`. *)
Variables x1 y1 z1 x2 y2 z2 : R.
Let e := 2 * x error.
Let e_z := 2 * x error_z.
Hypotheses (x1_near : Rabs (x1 - (x b_x - x a_x)) <= e) (x2_near : Rabs (x2 - (x c_x - x a_x)) <= e).
Hypotheses (y1_near : Rabs (y1 - (x b_y - x a_y)) <= e) (y2_near : Rabs (y2 - (x c_y - x a_y)) <= e).
Hypotheses (z1_near : Rabs (z1 - (x b_z - x a_z)) <= e_z) (z2_near : Rabs (z2 - (x c_z - x a_z)) <= e_z).

(* Denormals may be kept or flushed: errors are at least what projection.v has. *)
Hypotheses (error_in : / 2 ^ 24 <= x error) (error_z_in : / 2 ^ 90 <= x error_z).
Local Notation h := h32.
Lemma h_below_errors : 0 < h <= / 2 ^ 126 /\ h <= / 2 ^ 30 * x error_z /\ h <= / 2 ^ 30 * x error /\
  0 <= x error * x error /\ / 2 ^ 114 <= x error * x error_z /\ / 2 ^ 48 <= x error * x error.
Proof.
  assert (h0 := h32_powers). assert (E := Rmult_le_compat (/ 2 ^ 24) (x error) (/ 2 ^ 90) (x error_z) ltac:(lra) ltac:(lra)
    error_in error_z_in).
  assert (F := Rmult_le_compat (/ 2 ^ 24) (x error) (/ 2 ^ 24) (x error) ltac:(lra) ltac:(lra) error_in error_in).
  repeat split; lra.
Qed.

Ltac near N1 N2 N3 N4 v C n :=
  assert (A := product_moves _ _ _ _ _ _ N1 N2); assert (B := product_moves _ _ _ _ _ _ N3 N4);
  apply near32 in C; unfold lost32 in C; cbn -[u32 h32 alpha] in C; unfold of_product, alpha in C;
  rewrite ?u32_value in C; simpl pow in C;
  apply between in A; apply between in B; apply between in C; apply Rabs_le;
  cbv [delta_x delta_y delta_z quotient_4_over real]; unfold e, e_z in *;
  replace (Q2R 2) with 2 in * by (unfold Q2R; simpl; lra);
  replace (Q2R (1 # 4194304)) with (/ 4194304) in * by (unfold Q2R; simpl; lra).

Ltac errors_are_positive :=
  destruct h_below_errors as (h0 & hz & he & E1 & E2 & E3); assert (hh : 0 <= h * h <= / 2 ^ 126 * h) by (split; [apply
    Rmult_le_pos | apply Rmult_le_compat_r]; lra);
  repeat match goal with |- context [Rabs ?y] => lazymatch goal with
    | _ : Rabs y * h <= _ /\ _ |- _ => fail
    | _ => assert (Rabs y * h <= Rabs y * (/ 2 ^ 30 * x error) /\ Rabs y * h <= Rabs y * (/ 2 ^ 30 * x error_z) /\
             0 <= Rabs y * h)
           by (repeat split; [apply Rmult_le_compat_l | apply Rmult_le_compat_l | apply Rmult_le_pos];
               try apply Rabs_pos; lra) end end;
  repeat match goal with |- context [Rabs ?y * Rabs ?z] => lazymatch goal with
    | _ : 0 <= Rabs y * Rabs z |- _ => fail
    | _ => assert (0 <= Rabs y * Rabs z) by (apply Rmult_le_pos; apply Rabs_pos) end end.

Theorem n_x_near v : computes32 x n_x v -> Rabs ((y1 * z2 - z1 * y2) - v) <= (1 + / 300) * real x delta_x.
Proof. intros C. near y1_near z2_near z1_near y2_near v C n_x. errors_are_positive. lra. Qed.
Theorem n_y_near v : computes32 x n_y v -> Rabs ((z1 * x2 - x1 * z2) - v) <= (1 + / 300) * real x delta_y.
Proof. intros C. near z1_near x2_near x1_near z2_near v C n_y. errors_are_positive. lra. Qed.
Theorem n_z_near v : computes32 x n_z v -> Rabs ((x1 * y2 - y1 * x2) - v) <= (1 + / 300) * real x delta_z.
Proof. intros C. near x1_near y2_near y1_near x2_near v C n_z. errors_are_positive. lra. Qed.

(* ---- The quotient of the margin, as it is computed ---- *)
Definition R_sum := Add (Add (Given error 0) (Given greater_3 0)) (Given point_error 0).
Definition E_sum := Add (Given error 0) (Given point_error 0).
(* N is n as it is computed: one float, wherever it is used. *)
Definition N_x := 90%nat.
Definition N_y := 91%nat.
Definition N_z := 92%nat.
Definition size_of n m := Add (Abs n) (Abs m).
Definition over_of size := Add (Add (Add (Mul delta_x R_sum) (Mul delta_y R_sum)) (Mul delta_z (Given quotient_3 5)))
  (Mul size E_sum).
Definition over_3_of size := Mul size R_sum.
Definition under_of n := Sub (Abs n) (Times inflation delta_z).
Lemma quotients_are : quotient_1_over = Neg n_x /\ quotient_2_over = Neg n_y /\ quotient_1_under = n_z /\
  quotient_2_under = n_z /\ quotient_3_over = over_3_of (size_of n_x n_y) /\ quotient_3_under = under_of n_z /\
  quotient_4_over = over_of (size_of n_x n_y) /\ quotient_4_under = under_of n_z.
Proof. repeat split. Qed.
Ltac positive_products :=
  assert (e0 : 0 <= x error) by (simpl in *; lra); assert (z0 : 0 <= x error_z) by (simpl in *; lra);
  repeat match goal with |- context [Rabs ?y] => lazymatch goal with
    | _ : 0 <= Rabs y * x error |- _ => fail
    | _ => assert (0 <= Rabs y * x error) by (apply Rmult_le_pos; [apply Rabs_pos | exact e0]);
           assert (0 <= Rabs y * x error_z) by (apply Rmult_le_pos; [apply Rabs_pos | exact z0]) end end.
Lemma delta_least d v : List.In d (delta_x :: delta_y :: delta_z :: nil)%list -> computes32 x d v ->
  (1 - / 500) * real x d <= v /\ / 2 ^ 111 <= real x d.
Proof.
  intros I C. apply near32 in C.
  assert (F : lost32 x d <= / 900 * real x d /\ / 2 ^ 111 <= real x d /\ permanent x d = real x d).
  { destruct I as [<- | [<- | [<- | []]]]; (repeat split;
      [unfold lost32; cbn -[u32 h32 Q2R]; unfold of_product, alpha; rewrite ?u32_value; simpl pow | cbn -[Q2R] |
       cbn -[Q2R]; rewrite ?Rabs_Rabsolu, ?(Rabs_pos_eq (x error)), ?(Rabs_pos_eq (x error_z)), ?(Rabs_pos_eq (Q2R _))
         by (try (unfold Q2R; simpl); simpl in *; lra); reflexivity]);
    rewrite ?(Rabs_pos_eq (Q2R _)), ?(Rabs_pos_eq (x error)), ?(Rabs_pos_eq (x error_z)), ?Rabs_Rabsolu
      by (try (unfold Q2R; simpl); simpl in *; lra);
    replace (Q2R 2) with 2 by (unfold Q2R; simpl; lra); replace (Q2R (1 # 4194304)) with (/ 4194304) by (unfold Q2R; simpl; lra);
    errors_are_positive;
    positive_products;
    assert (g1 := Rmult_le_compat_l _ _ _ e0 hz); assert (g2 := Rmult_le_compat_l _ _ _ z0 he);
    assert (g3 := Rmult_le_compat_l _ _ _ e0 he); assert (g4 := Rmult_le_pos _ _ e0 (Rlt_le _ _ (proj1 h0)));
    assert (g5 := Rmult_le_pos _ _ z0 (Rlt_le _ _ (proj1 h0)));
    simpl in *; lra. }
  destruct F as (F1 & F2 & F3). rewrite F3 in C. split; [| exact F2].
  assert (A : alpha u32 (roundings d) <= 16 * (1 + / 1048576) * / 16777216).
  { eapply Rle_trans; [apply (alpha_grows u32 (bpow_ge_0 _ _) _ 16) | eapply Rle_trans; [apply alpha_below |]; simpl INR; [lia | lra]].
    destruct I as [<- | [<- | [<- | []]]]; vm_compute; lia. }
  assert (P0 : 0 <= real x d) by (simpl in *; lra). assert (G := Rmult_le_compat_r _ _ _ P0 A). apply between in C. lra.
Qed.
Lemma deltas_in : / 2 ^ 111 <= real x delta_x /\ / 2 ^ 111 <= real x delta_y /\ / 2 ^ 111 <= real x delta_z.
Proof.
  repeat split; cbn -[Q2R]; replace (Q2R 2) with 2 by (unfold Q2R; simpl; lra);
    replace (Q2R (1 # 4194304)) with (/ 4194304) by (unfold Q2R; simpl; lra); errors_are_positive; positive_products; simpl in *; lra.
Qed.
Lemma delta_z_in : / 2 ^ 45 <= real x delta_z.
Proof.
  cbn -[Q2R]; replace (Q2R 2) with 2 by (unfold Q2R; simpl; lra);
    replace (Q2R (1 # 4194304)) with (/ 4194304) by (unfold Q2R; simpl; lra); errors_are_positive; positive_products; simpl in *; lra.
Qed.

(* rho is half a texel at least (edge_functions.v). *)
Definition size_n := size_of (Given N_x 0) (Given N_y 0).
Let N := Rabs (x N_x) + Rabs (x N_y).
Lemma N_positive : 0 <= N.
Proof. apply Rplus_le_le_0_compat; apply Rabs_pos. Qed.
Hypotheses (greater_3_in : / 2 <= x greater_3) (point_error0 : 0 <= x point_error).
Let rho := real x R_sum.
Let reach_error := real x E_sum.
Local Notation u := (/ 16777216).
Lemma sums_in : / 2 <= rho /\ / 2 ^ 24 <= reach_error <= rho.
Proof. unfold rho, reach_error. cbn. assert (E := error_in). simpl in *. repeat split; lra. Qed.
Lemma rho_least v : computes32 x R_sum v -> (1 - 3 * u) * rho <= v.
Proof.
  intros C. assert (E := error_in). destruct h32_powers as [h0 hh]. unfold rho. cbn. simpl in *.
  assert (given : forall i p, computes32 x (Given i 0) p -> x i <= p) by (intros; now apply (least_given x i)).
  assert (M : forall p, computes32 x (Add (Given error 0) (Given greater_3 0)) p ->
    (1 - u) * (x error + x greater_3) - 4 * h <= p).
  { intros p D. apply (least_add x _ _ (x error) (x greater_3) p D); auto; lra. }
  assert (M2 := least_add x _ _ ((1 - u) * (x error + x greater_3) - 4 * h) (x point_error) v C ltac:(lra) point_error0 M
    (given point_error)).
  lra.
Qed.
Lemma reach_error_least v : computes32 x E_sum v -> (1 - 2 * u) * reach_error <= v.
Proof.
  intros C. assert (E := error_in). destruct h32_powers as [h0 hh]. unfold reach_error. cbn. simpl in *.
  assert (given : forall i p, computes32 x (Given i 0) p -> x i <= p) by (intros; now apply (least_given x i)).
  assert (M2 := least_add x _ _ (x error) (x point_error) v C ltac:(lra) point_error0 (given error) (given point_error)). lra.
Qed.
Lemma size_least v : computes32 x size_n v -> Rmax 0 ((1 - u) * N - 7 * h) <= v.
Proof.
  intros C. destruct h32_powers as [h0 hh]. apply Rmax_lub; [exact (positive_is x size_n v (conj I I) C) |].
  assert (one : forall i p, computes32 x (Abs (Given i 0)) p -> Rmax 0 (Rabs (x i) - h) <= p).
  { intros i p D. apply Rmax_lub; [exact (positive_is x (Abs (Given i 0)) p I D) | now apply least_abs_given]. }
  assert (M := least_add x _ _ _ _ v C (Rmax_l _ _) (Rmax_l _ _) (one N_x) (one N_y)).
  assert (M1 := Rmax_r 0 (Rabs (x N_x) - h)). assert (M2 := Rmax_r 0 (Rabs (x N_y) - h)). unfold N. lra.
Qed.
(* With what is lost of the product of delta_z, which may underflow where no other does. *)
Hypothesis quotient_3_positive : 0 <= x quotient_3.
Let D_x := real x delta_x. Let D_y := real x delta_y. Let D_z := real x delta_z.
Theorem over_least v : computes32 x (over_of size_n) v ->
  (1 - / 300) * (D_x * rho + D_y * rho + D_z * x quotient_3 + N * reach_error) - 2 * h * D_z <= v.
Proof.
  intros C. destruct h32_powers as [h0 hh]. destruct sums_in as [r0 [s0 s1]].
  assert (dx : forall p, computes32 x delta_x p -> (1 - / 500) * D_x <= p) by (intros p D; apply (delta_least delta_x p ltac:(cbn; tauto) D)).
  assert (dy : forall p, computes32 x delta_y p -> (1 - / 500) * D_y <= p) by (intros p D; apply (delta_least delta_y p ltac:(cbn; tauto) D)).
  assert (dz : forall p, computes32 x delta_z p -> (1 - / 500) * D_z <= p) by (intros p D; apply (delta_least delta_z p ltac:(cbn; tauto) D)).
  assert (least : / 2 ^ 111 <= D_x /\ / 2 ^ 111 <= D_y /\ / 2 ^ 111 <= D_z) by exact deltas_in.
  destruct least as (x0 & y0 & z0). simpl in h0, hh, x0, y0, z0, s0.
  assert (q : forall p, computes32 x (Given quotient_3 5) p -> (1 - 6 * u) * x quotient_3 <= p).
  { intros p D. apply near32 in D. unfold lost32 in D. cbn -[u32 h32 alpha] in D. assert (A := alpha_below 5 ltac:(lia)). simpl INR in A.
    rewrite (Rabs_pos_eq (x quotient_3)) in D by exact quotient_3_positive.
    assert (G := Rmult_le_compat_r _ _ _ quotient_3_positive A). apply between in D. lra. }
  assert (of_rho : forall d D, / 2 ^ 111 <= D -> (forall p, computes32 x d p -> (1 - / 500) * D <= p) -> forall p,
    computes32 x (Mul d R_sum) p -> (1 - / 450) * (D * rho) <= p).
  { intros d D D0 H p Cp. simpl in D0.
    assert (M := least_mul x _ _ ((1 - / 500) * D) ((1 - 3 * u) * rho) p Cp ltac:(lra) ltac:(lra) H rho_least).
    assert (k1 := Rmult_le_compat_l D _ _ ltac:(lra) r0). assert (k2 := Rmult_le_compat_r rho _ _ ltac:(lra) D0).
    assert (k3 := Rmult_le_compat_r D _ _ ltac:(lra) (proj2 h0)). assert (k4 := Rmult_le_compat_r rho _ _ ltac:(lra) (proj2 h0)).
    assert (k5 := Rmult_le_pos h D ltac:(lra) ltac:(lra)). assert (k6 := Rmult_le_pos h rho ltac:(lra) ltac:(lra)). lra. }
  assert (q0 := quotient_3_positive). set (Q3 := x quotient_3) in *.
  assert (hq : 0 <= h * Q3 <= / 2 ^ 126 * Q3) by (split; [apply Rmult_le_pos; lra | apply Rmult_le_compat_r; simpl; lra]).
  assert (hz : 0 <= h * D_z) by (apply Rmult_le_pos; lra). simpl in hq.
  assert (zz : / 2 ^ 45 <= D_z) by exact delta_z_in. simpl in zz. assert (zq := Rmult_le_compat_r Q3 _ _ q0 zz).
  assert (of_z : forall p, computes32 x (Mul delta_z (Given quotient_3 5)) p ->
    Rmax 0 ((1 - / 450) * (D_z * Q3) - h * D_z - 2 * h) <= p).
  { intros p Cp. assert (M := least_mul x _ _ ((1 - / 500) * D_z) ((1 - 6 * u) * Q3) p Cp ltac:(lra) ltac:(lra) dz q). apply Rmax_lub; [| lra].
    assert (zq0 : 0 <= D_z * Q3) by (apply Rmult_le_pos; lra).
    inversion Cp as [ | | | | | | | | ? ? a b sa sb ? Ca Cb Sa Sb R | ]; subst. apply dz in Ca. apply q in Cb.
    apply (proj2 (rounds32_positive _ _ R)). apply Rmult_le_pos; [apply (proj2 (seen32_positive _ _ Sa)) | apply (proj2
      (seen32_positive _ _ Sb))]; lra. }
  assert (N0 := N_positive).
  assert (hN : 0 <= h * N <= / 2 ^ 126 * N) by (split; [apply Rmult_le_pos; lra | apply Rmult_le_compat_r; simpl; lra]).
  simpl in hN. assert (Ns := Rmult_le_compat_l N _ _ N0 s0). assert (hs := Rmult_le_compat_l h _ _ ltac:(lra) s1).
  assert (hs0 : 0 <= h * reach_error) by (apply Rmult_le_pos; lra).
  assert (of_size : forall p, computes32 x (Mul size_n E_sum) p ->
    Rmax 0 ((1 - / 450) * (N * reach_error) - 9 * h * rho - 2 * h) <= p).
  { intros p Cp. set (B := Rmax 0 ((1 - u) * N - 7 * h)).
    assert (M := least_mul x _ _ B ((1 - 2 * u) * reach_error) p Cp (Rmax_l _ _) ltac:(lra) size_least reach_error_least).
    assert (B1 : (1 - u) * N - 7 * h <= B) by apply Rmax_r. assert (B2 : B <= N) by (apply Rmax_lub; lra).
    assert (B3 := Rmult_le_compat_r reach_error _ _ ltac:(lra) B1). assert (B4 := Rmult_le_compat_l h _ _ ltac:(lra) B2).
    assert (N1 : 0 <= N * reach_error) by (apply Rmult_le_pos; lra). apply Rmax_lub; [| lra].
    inversion Cp as [ | | | | | | | | ? ? a b sa sb ? Ca Cb Sa Sb R | ]; subst. apply size_least in Ca.
    apply reach_error_least in Cb. assert (a0 := Rle_trans _ _ _ (Rmax_l _ _) Ca).
    apply (proj2 (rounds32_positive _ _ R)). apply Rmult_le_pos; [apply (proj2 (seen32_positive _ _ Sa)) | apply (proj2
      (seen32_positive _ _ Sb))]; lra. }
  assert (ox := of_rho delta_x D_x ltac:(simpl; lra) dx). assert (oy := of_rho delta_y D_y ltac:(simpl; lra) dy).
  assert (X0 : / 2 ^ 112 <= D_x * rho) by (assert (K := Rmult_le_compat (/ 2 ^ 111) D_x (/ 2) rho ltac:(simpl; lra) ltac:(lra) ltac:(simpl; lra) r0); simpl in *; lra).
  assert (Y0 : / 2 ^ 112 <= D_y * rho) by (assert (K := Rmult_le_compat (/ 2 ^ 111) D_y (/ 2) rho ltac:(simpl; lra) ltac:(lra) ltac:(simpl; lra) r0); simpl in *; lra).
  assert (hr : h * rho <= / 2 ^ 14 * (D_x * rho)).
  { assert (K := Rmult_le_compat_r rho h (/ 2 ^ 14 * D_x) ltac:(lra) ltac:(simpl; lra)). lra. }
  simpl in X0, Y0, hr.
  set (S1 := (1 - u) * ((1 - / 450) * (D_x * rho) + (1 - / 450) * (D_y * rho)) - 4 * h).
  assert (M1 : forall p, computes32 x (Add (Mul delta_x R_sum) (Mul delta_y R_sum)) p -> S1 <= p).
  { intros p D. unfold S1. apply (least_add x _ _ ((1 - / 450) * (D_x * rho)) ((1 - / 450) * (D_y * rho)) p D); auto; lra. }
  set (Z := Rmax 0 ((1 - / 450) * (D_z * Q3) - h * D_z - 2 * h)) in *. set (S2 := (1 - u) * (S1 + Z) - 4 * h).
  assert (Z0 : 0 <= Z) by apply Rmax_l. assert (S10 : / 2 ^ 113 <= S1) by (unfold S1; simpl; lra). simpl in S10.
  assert (M2 : forall p, computes32 x (Add (Add (Mul delta_x R_sum) (Mul delta_y R_sum)) (Mul delta_z (Given quotient_3 5))) p ->
    S2 <= p).
  { intros p D. unfold S2. apply (least_add x _ _ S1 Z p D); auto; lra. }
  assert (z3 : (1 - / 450) * (D_z * Q3) - h * D_z - 2 * h <= Z) by apply Rmax_r.
  assert (n3 := Rmax_r 0 ((1 - / 450) * (N * reach_error) - 9 * h * rho - 2 * h)).
  assert (n4 := Rmax_l 0 ((1 - / 450) * (N * reach_error) - 9 * h * rho - 2 * h)).
  assert (M3 := least_add x _ _ S2 _ v C ltac:(unfold S2; lra) n4 M2 of_size). unfold S2, S1 in M3.
  assert (zq0 : 0 <= D_z * Q3) by (apply Rmult_le_pos; lra). assert (N1 : 0 <= N * reach_error) by (apply Rmult_le_pos; lra).
  lra.
Qed.
Lemma over_3_least v : computes32 x (over_3_of size_n) v ->
  (1 - / 2 ^ 21) * (N * rho) - 9 * h * rho - 2 * h <= v /\ 0 <= v.
Proof.
  intros C. destruct h32_powers as [h0 hh]. destruct sums_in as [r0 _]. simpl in h0.
  assert (N0 := N_positive). set (B := Rmax 0 ((1 - u) * N - 7 * h)).
  assert (M := least_mul x _ _ B ((1 - 3 * u) * rho) v C (Rmax_l _ _) ltac:(lra) size_least rho_least).
  assert (B1 : (1 - u) * N - 7 * h <= B) by apply Rmax_r. assert (B2 : B <= N) by (apply Rmax_lub; lra).
  assert (B3 := Rmult_le_compat_r rho _ _ ltac:(lra) B1). assert (B4 := Rmult_le_compat_l h _ _ ltac:(lra) B2).
  assert (N1 : 0 <= N * rho) by (apply Rmult_le_pos; lra). assert (N2 := Rmult_le_compat_l N _ _ N0 r0).
  assert (hN : 0 <= h * N <= / 2 ^ 126 * N) by (split; [apply Rmult_le_pos; lra | apply Rmult_le_compat_r; simpl; lra]).
  assert (hr : 0 <= h * rho) by (apply Rmult_le_pos; lra). simpl in hN. split; [simpl; lra |].
  inversion C as [ | | | | | | | | ? ? a b sa sb ? Ca Cb Sa Sb R | ]; subst. apply size_least in Ca.
  apply rho_least in Cb. assert (a0 := Rle_trans _ _ _ (Rmax_l _ _) Ca).
  apply (proj2 (rounds32_positive _ _ R)). apply Rmult_le_pos; [apply (proj2 (seen32_positive _ _ Sa)) | apply (proj2
    (seen32_positive _ _ Sb))]; lra.
Qed.
Theorem under_most w : computes32 x (under_of (Given N_z 0)) w -> 0 < w ->
  w <= (1 + 2 * u) * (Rabs (x N_z) - (1 + / 256) * D_z).
Proof.
  intros C w0.
  destruct h32_powers as [h0 hh]. simpl in h0. assert (zz : / 2 ^ 45 <= D_z) by exact delta_z_in. simpl in zz.
  destruct (step32_sub _ _ _ _ C) as (p & t & Cp & Ct & R).
  assert (p_is : p <= Rabs (x N_z) + h).
  { inversion Cp as [ | | | | | ? q s Cq S | | | | ]; subst. apply given32_is in Cq. subst q. apply seen32_near in S.
    assert (T := Rabs_triang (s - x N_z) (x N_z)). replace (s - x N_z + x N_z) with s in T by ring. lra. }
  assert (i : 10099 / 10000 <= Q2R inflation <= 2).
  { replace (10099 / 10000) with (Q2R (10099 # 10000)) by (unfold Q2R; simpl; lra). rewrite <- Q2R_2.
    split; apply Qle_Rle, Qle_bool_iff; vm_compute; reflexivity. }
  assert (M := least_times x inflation delta_z ((1 - / 500) * D_z) t Ct ltac:(lra) ltac:(lra)
    ltac:(intros q D; apply (delta_least delta_z q ltac:(cbn; tauto) D))).
  assert (iz := Rmult_le_compat_r ((1 - / 500) * D_z) _ _ ltac:(lra) (proj1 i)).
  assert (ih := Rmult_le_compat_l h _ _ ltac:(lra) (proj2 i)).
  destruct (Rle_dec 0 (p - t)) as [pos | neg].
  - rewrite (Rabs_pos_eq (p - t)) in R by exact pos. apply between in R. lra.
  - rewrite (Rabs_left (p - t)) in R by lra. apply between in R. lra.
Qed.
(* So the margin's quotient is at least what plane_moves asks for, with the normal's errors of n_x_near and so on. *)
Definition of_quotient : Q := 1 + (85 # 10000).
Theorem quotient_is_enough v w v_3 s_3 : computes32 x (over_of size_n) v -> computes32 x (under_of (Given N_z 0)) w ->
  computes32 x (over_3_of size_n) v_3 -> seen32 v_3 s_3 -> Rabs (x quotient_3 - s_3 / w) <= h -> 0 < w ->
  Rabs (x N_z) <= 5 * w ->
  let d_x := (1 + / 256) * D_x in let d_y := (1 + / 256) * D_y in let d_z := (1 + / 256) * D_z in
  d_z < Rabs (x N_z) /\
  (d_x * rho + d_y * rho + d_z * (N * rho / Rabs (x N_z)) + N * reach_error) / (Rabs (x N_z) - d_z) <=
  Q2R of_quotient * (v / w) + / 2 ^ 110.
Proof.
  intros Cv Cw C3 S3 H3 w0 usable d_x d_y d_z. assert (V := over_least _ Cv). assert (W := under_most _ Cw w0).
  destruct (over_3_least _ C3) as [V3 v30]. destruct h32_powers as [h0 hh]. destruct sums_in as [r0 [s0 s1]].
  destruct deltas_in as (x0 & y0 & z0). fold D_x in x0. fold D_y in y0. fold D_z in z0.
  replace (Q2R of_quotient) with (10085 / 10000) by (unfold Q2R, of_quotient; simpl; lra).
  assert (N0 := N_positive). set (n := Rabs (x N_z)) in *. fold d_z in W. set (G := n - d_z) in *.
  simpl in h0, x0, y0, z0, s0.
  assert (G0 : 0 < G) by lra. split; [unfold G in G0; lra |]. assert (dz0 : 0 <= d_z) by (unfold d_z; lra). assert (Nz : 0 < n) by (unfold G in G0; lra).
  assert (IG := Rinv_0_lt_compat _ G0). assert (Iw := Rinv_0_lt_compat _ w0). assert (IN := Rinv_0_lt_compat _ Nz).
  assert (Gw : / G <= (1 + 2 * u) * / w).
  { apply Rmult_le_reg_r with G; [exact G0 |]. rewrite Rinv_l by lra.
    assert (K := Rmult_le_compat_r (/ w) _ _ ltac:(lra) W). rewrite Rinv_r in K by lra. lra. }
  assert (wN : / n <= (1 + 2 * u) * / w).
  { apply Rle_trans with (/ G); [| exact Gw]. apply Rinv_le_contravar; [exact G0 | unfold G; lra]. }
  (* rho_z, from the computed quotient. *)
  set (q := N * rho * / n). assert (Nr : 0 <= N * rho) by (apply Rmult_le_pos; lra).
  assert (hr : h * rho <= / 2 ^ 15 * (D_x * rho)).
  { assert (K := Rmult_le_compat_r rho h (/ 2 ^ 15 * D_x) ltac:(lra) ltac:(simpl; lra)). lra. }
  assert (hr0 : 0 <= h * rho) by (apply Rmult_le_pos; lra). simpl in hr.
  assert (Z1 : d_z * / n <= 1).
  { apply Rmult_le_reg_r with n; [exact Nz |]. rewrite Rmult_assoc, Rinv_l by lra. unfold G in G0. lra. }
  assert (Z2 : 0 <= d_z * / n) by (apply Rmult_le_pos; lra).
  assert (q_is : d_z * q <= (1 + / 2 ^ 18) * (d_z * x quotient_3) + (1 + / 2 ^ 18) * (d_z * h) + 11 * (h * rho) + 9 * h).
  { assert (K1 : v_3 * / n <= (1 + 2 * u) * (v_3 / w)).
    { assert (K := Rmult_le_compat_l v_3 _ _ v30 wN). unfold Rdiv. lra. }
    apply seen32_near, between in S3. assert (S := Rmult_le_compat_r (/ w) _ _ ltac:(lra) (proj1 S3)). fold (Rdiv s_3 w) in S.
    assert (Zw : d_z * / w <= 5).
    { apply Rmult_le_reg_r with w; [exact w0 |]. rewrite Rmult_assoc, Rinv_l by lra. unfold G in G0. lra. }
    assert (hw := Rmult_le_compat_l h _ _ ltac:(lra) Zw).
    apply between in H3. assert (K2 : v_3 * / n <= (1 + 2 * u) * (x quotient_3 + h + h * / w)) by (unfold Rdiv in *; lra).
    assert (K3 := Rmult_le_compat_r (/ n) _ _ ltac:(lra) V3).
    assert (K4 : (1 - / 2 ^ 21) * q <= v_3 * / n + (9 * (h * rho) + 2 * h) * / n) by (unfold q; lra).
    assert (K5 := Rmult_le_compat_l d_z _ _ dz0 K4). assert (K6 := Rmult_le_compat_l d_z _ _ dz0 K2).
    assert (K7 := Rmult_le_compat_r (9 * (h * rho) + 2 * h) _ _ ltac:(lra) Z1).
    assert (q0 : 0 <= q) by (unfold q; apply Rmult_le_pos; lra). assert (K8 := Rmult_le_pos _ _ dz0 q0).
    assert (K9 := Rmult_le_pos _ _ dz0 quotient_3_positive). assert (Ka := Rmult_le_pos _ _ dz0 (Rlt_le _ _ (proj1 h0))).
    simpl in *. lra. }
  set (T := d_x * rho + d_y * rho + d_z * q + N * reach_error).
  assert (xr : 0 <= D_x * rho) by (apply Rmult_le_pos; lra). assert (yr : 0 <= D_y * rho) by (apply Rmult_le_pos; lra).
  assert (zr : 0 <= D_z * x quotient_3) by (apply Rmult_le_pos; [lra | exact quotient_3_positive]).
  assert (Ne : 0 <= N * reach_error) by (apply Rmult_le_pos; lra).
  assert (hz : 0 <= h * D_z) by (apply Rmult_le_pos; lra).
  assert (hx : h <= / 2 ^ 14 * (D_x * rho)).
  { assert (K := Rmult_le_compat (/ 2 ^ 111) D_x (/ 2) rho ltac:(simpl; lra) ltac:(lra) ltac:(simpl; lra) r0). simpl in *. lra. }
  simpl in hx.
  assert (T_is : T <= 10084 / 10000 * v + 5 * (h * D_z)) by (unfold T, d_x, d_y, d_z in *; simpl in q_is; lra).
  assert (v0 : 0 <= 10084 / 10000 * v + 5 * (h * D_z)).
  { eapply Rle_trans; [| exact T_is]. unfold T, d_x, d_y, d_z, q. repeat first [lra | apply Rplus_le_le_0_compat | apply Rmult_le_pos]. }
  replace (d_x * rho + d_y * rho + d_z * (N * rho / n) + N * reach_error) with T by (unfold T, q, Rdiv; ring).
  unfold Rdiv. eapply Rle_trans; [apply Rmult_le_compat; [| lra | exact T_is | exact Gw] |].
  - unfold T, d_x, d_y, d_z, q. repeat first [lra | apply Rplus_le_le_0_compat | apply Rmult_le_pos].
  - assert (zw : D_z * / w <= 5).
    { apply Rmult_le_reg_r with w; [exact w0 |]. rewrite Rmult_assoc, Rinv_l by lra. unfold G, d_z in G0. lra. }
    assert (K := Rmult_le_compat_l h _ _ ltac:(lra) zw). assert (hzw : 0 <= h * (D_z * / w)) by (apply Rmult_le_pos; [lra |
      apply Rmult_le_pos; lra]). assert (vw : - (5 * (h * (D_z * / w))) <= 10084 / 10000 * (v * / w)).
    { assert (K2 := Rmult_le_compat_r (/ w) _ _ ltac:(lra) v0). lra. }
    simpl in *. lra.
Qed.
(* So the real plane at the real point, (X', Y') from the real a at height A, is within the margin's quotient and error_z of the
   plane that N gives at the grid's point, (P, Q) from a: of_quotients has its slopes, whose quotients see n_x and n_y kept or
   flushed (n_z is no denormal). *)
Theorem plane_is_near v w v_3 s_3 s_x s_y X' Y' P Q A :
  computes32 x n_x (x N_x) -> computes32 x n_y (x N_y) -> computes32 x n_z (x N_z) ->
  computes32 x (over_of size_n) v -> computes32 x (under_of (Given N_z 0)) w ->
  computes32 x (over_3_of size_n) v_3 -> seen32 v_3 s_3 -> Rabs (x quotient_3 - s_3 / w) <= h -> 0 < w ->
  Rabs (x N_z) <= 5 * w -> seen32 (x N_x) s_x -> seen32 (x N_y) s_y ->
  Rabs X' <= rho -> Rabs Y' <= rho -> Rabs P <= rho -> Rabs Q <= rho ->
  Rabs (X' - P) <= reach_error -> Rabs (Y' - Q) <= reach_error -> Rabs (A - x a_z) <= x error_z ->
  Rabs ((A - ((y1 * z2 - z1 * y2) * X' + (z1 * x2 - x1 * z2) * Y') / (x1 * y2 - y1 * x2)) -
    (x a_z + (- s_x / x N_z * P + - s_y / x N_z * Q))) <= Q2R of_quotient * (v / w) + / 2 ^ 110 + x error_z.
Proof.
  intros Cx Cy Cz Cv Cw C3 S3 H3 w0 usable Sx Sy HX HY HP HQ NX NY NA.
  destruct (quotient_is_enough _ _ _ _ Cv Cw C3 S3 H3 w0 usable) as [steep enough].
  apply n_x_near in Cx. apply n_y_near in Cy. apply n_z_near in Cz. fold D_x in Cx. fold D_y in Cy. fold D_z in Cz, steep, enough.
  destruct h32_powers as [h0 hh]. destruct deltas_in as (x0 & y0 & z0). fold D_x in x0. fold D_y in y0. fold D_z in z0.
  destruct sums_in as [r0 [s0 s1]].
  assert (seen : forall p s m D, seen32 p s -> Rabs (m - p) <= (1 + / 300) * D ->
    / 2 ^ 111 <= D -> Rabs (m - s) <= (1 + / 256) * D /\ Rabs s <= Rabs p).
  { intros p s m D S M D0. split.
    - apply seen32_near in S. apply between in S, M. apply Rabs_le. simpl in *. lra.
    - destruct S as [-> | [_ ->]]; [lra | rewrite Rabs_R0; apply Rabs_pos]. }
  destruct (seen _ _ _ _ Sx Cx x0) as [Mx Lx]. destruct (seen _ _ _ _ Sy Cy y0) as [My Ly].
  simpl in h0, x0, y0, z0, s0. assert (Mz : Rabs (x1 * y2 - y1 * x2 - x N_z) <= (1 + / 256) * D_z) by lra.
  eapply Rle_trans; [exact (plane_moves _ _ _ _ _ _ _ _ _ _ _ _ _ _ _ _ _ _ Mx My Mz HX HY HP HQ NX NY NA steep) |].
  apply Rplus_le_compat_r. eapply Rle_trans; [| exact enough].
  assert (G := Rinv_0_lt_compat (Rabs (x N_z) - (1 + / 256) * D_z) ltac:(lra)).
  assert (n0 : 0 < Rabs (x N_z)) by lra. assert (I := Rinv_0_lt_compat _ n0).
  apply Rmult_le_compat_r; [lra |]. unfold Rdiv.
  assert (sum : Rabs s_x + Rabs s_y <= N) by (unfold N; lra).
  assert (K1 := Rmult_le_compat_r rho _ _ ltac:(lra) sum). assert (K2 := Rmult_le_compat_r (/ Rabs (x N_z)) _ _ ltac:(lra) K1).
  assert (K3 := Rmult_le_compat_l ((1 + / 256) * D_z) _ _ ltac:(lra) K2).
  assert (K4 := Rmult_le_compat_r reach_error _ _ ltac:(lra) sum). lra.
Qed.
End Plane.

(* What the margin multiplies with 1.01 has only positive terms, so that it is computed at least at this much of its size; its
   quotient has met 5 roundings more. *)
Lemma inflation_is_enough : Qle_bool of_quotient (inflation * (1 - alphaQ u32Q (roundings margin + 5))) = true.
Proof. vm_compute. reflexivity. Qed.

(* What underflow takes of a height, of its slopes and of the margin, and in proportion to L. *)
Lemma kernel_is_enough :
  ((1 # 2 ^ 82) + (1 # 2 ^ 84) + (1 # 2 ^ 96) + (1 # 2 ^ 109) <= of_nothing * (1 - (1 # 2 ^ 20)) /\
   least_bound + (1 # 2 ^ 100) <= of_largest)%Q.
Proof. vm_compute. split; discriminate. Qed.

Definition constants := Eval vm_compute in shown least_bound of_largest.
Print constants.
Definition checked := (rounding, of_quotients, margin_near, n_x_near, n_y_near, n_z_near, quotients_are, over_least, under_most,
  quotient_is_enough, plane_moves, plane_is_near, inflation_is_enough, kernel_is_enough).
Print Assumptions checked.
