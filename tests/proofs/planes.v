(* SPDX-License-Identifier: MIT *)
(* triangle_records.clh, set_plane_parallel(): how far a plane's height at a point of the grid may be from the real
  plane's
   at the real point (docs/numerics.md, 4). Three parts, each a theorem:
     rounding              the computed height, from the record's numbers: 20 u L;
     n_x_near and so on    the normal: delta_x, delta_y, delta_z;
     plane_moves           what errors of normal, corner and point do to the height: the margin's quotient and error_z.
   height_error on top is the point's own.

   Assumed: x and y of corners are off by at most `error`, from 2^-24 on, z by error_z, from 2^-91 on (projection.v); |X|,
   |Y|, |a_x| and |a_y| are at most what L multiplies the slopes with; a quotient is off by 2.5 ulp. Of the normal, denormals
   may be kept or flushed: what underflow takes is less than 2^-8 of the delta. Of the height and of the margin's own sums and
   quotients no result is below 2^-126 unless it is 0 (2^-90 in error_z covers underflow but in scenes less than about 1e-18
   high whose denormals are flushed: prose). `safe_n_z` subtracts 1.01 delta_z and rounds once: at most |n_z| less the real
   delta_z. Overflow: no height is certain where the margin is infinite. *)
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
(* margin: where mul(add(add(add(quotient_4, error_z), height_error), mul(add(abs(a_z), add(mul(abs(quotient_1),
   greater_4), mul(abs(quotient_2), greater_5))), 1.1920928955078125e-06)), 1.0099999904632568) < infinity *)
(* margin: where mul(quotient_2_under, orientation) > 0.0 *)
(* margin: where quotient_4_under > mul(abs(quotient_2_under), 0.25) *)
Definition margin :=
  Times (4236247 # 4194304) (Add (Add (Add (Given quotient_4 5) (Given error_z 0)) (Given height_error 0)) (Times (5
    # 4194304) (Add (Abs (Given a_z 0)) (Add (Mul (Abs (Given quotient_1 5)) (Given greater_4 0)) (Mul (Abs (Given
    quotient_2 5)) (Given greater_5 0)))))).
(* where mul(quotient_2_under, orientation) > 0.0 *)
(* where quotient_4_under > mul(abs(quotient_2_under), 0.25) *)
(* where margin < infinity *)
(* end: from the kernels *)

Section Plane.
Variable x : nat -> R.
Open Scope R_scope.

(* ---- The height's roundings ---- *)
Hypotheses (a_x_in : Rabs (x a_x) <= x greater_4) (a_y_in : Rabs (x a_y) <= x greater_5).
Hypotheses (X_in : Rabs (x X) <= x greater_4) (Y_in : Rabs (x Y) <= x greater_5).

Lemma height_is_the_planes :
  real x height = x a_z + x quotient_1 * (x X - x a_x) + x quotient_2 * (x Y - x a_y).
Proof. cbv [height plane_0 real]. ring. Qed.

(* L: the sum of the magnitudes that the margin multiplies with its constant. *)
Definition of_largest := match margin with Times _ (Add _ (Times c _)) => c | _ => 0%Q end.
Definition largest := match margin with Times _ (Add _ (Times _ l)) => l | _ => Const 0 end.
Definition inflation := match margin with Times i _ => i | _ => 0%Q end.
Lemma margin_is : margin = Times inflation
  (Add (Add (Add (Given quotient_4 5) (Given error_z 0)) (Given height_error 0)) (Times of_largest largest)).
Proof. reflexivity. Qed.
Definition twice := Times 2 largest.
(* The margin rounds five times more than `largest`, and once less than `twice`. *)
Definition constant : Q := of_largest * inflation * (1 # 2) * (1 - (6 # 2 ^ 24)).
Definition least_bound := Eval vm_compute in (2 * rate u32Q height twice / (inflation * (1 - (6 # 2 ^ 24))))%Q.

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

Theorem rounding v s :
  within_limits x (Q2R any) (Q2R any) height -> within_limits x (Q2R any) (Q2R any) twice ->
  computes_normal x height v -> computes_normal x twice s -> 0 <= s -> Rabs (v - real x height) <= Q2R constant * s.
Proof.
  assert (X0 := Rabs_pos (x X)). assert (Y0 := Rabs_pos (x Y)).
  assert (G4 := Rabs_pos_eq (x greater_4) ltac:(lra)). assert (G5 := Rabs_pos_eq (x greater_5) ltac:(lra)).
  assert (two : Rabs (Q2R 2) = Q2R 2) by (unfold Q2R; simpl; rewrite Rabs_pos_eq; lra).
  intros. eapply float_error_of_normal_numbers with (size := twice) (m := fun _ => any) (d := fun _ _ => any); try
    eassumption.
  - vm_compute. reflexivity.
  - apply products.
  - cbv [twice largest margin real permanent]. rewrite two, G4, G5. reflexivity.
Qed.

(* ---- The normal, and how far the heights move with it ---- *)
Definition delta_x := match quotient_4_over with Add (Add (Add (Mul d _) _) _) _ => d | _ => Const 0 end.
Definition delta_y := match quotient_4_over with Add (Add (Add _ (Mul d _)) _) _ => d | _ => Const 0 end.
Definition delta_z := match quotient_4_over with Add (Add _ (Mul d _)) _ => d | _ => Const 0 end.
Definition n_x := match quotient_1_over with Neg n => n | _ => Const 0 end.
Definition n_y := match quotient_2_over with Neg n => n | _ => Const 0 end.
Definition n_z := quotient_1_under.

Lemma product_moves p q p' q' e f :
  Rabs (p' - p) <= e -> Rabs (q' - q) <= f -> Rabs (p' * q' - p * q) <= Rabs p * f + Rabs q * e + e * f.
Proof.
  intros Hp Hq. replace (p' * q' - p * q) with ((p' - p) * (q' - q) + (p * (q' - q) + q * (p' - p))) by ring.
  assert (T := Rabs_triang ((p' - p) * (q' - q)) (p * (q' - q) + q * (p' - p))).
  assert (U := Rabs_triang (p * (q' - q)) (q * (p' - p))). rewrite !Rabs_mult in *.
  assert (A := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Hp Hq).
  assert (B := Rmult_le_compat_l _ _ _ (Rabs_pos p) Hq). assert (C := Rmult_le_compat_l _ _ _ (Rabs_pos q) Hp). lra.
Qed.

(* The real sides, (x1, y1, z1) and (x2, y2, z2), whose corners are off by `error` and `error_z`. *)
Variables x1 y1 z1 x2 y2 z2 : R.
Let e := 2 * x error.
Let e_z := 2 * x error_z.
Hypotheses (x1_near : Rabs (x1 - (x b_x - x a_x)) <= e) (x2_near : Rabs (x2 - (x c_x - x a_x)) <= e).
Hypotheses (y1_near : Rabs (y1 - (x b_y - x a_y)) <= e) (y2_near : Rabs (y2 - (x c_y - x a_y)) <= e).
Hypotheses (z1_near : Rabs (z1 - (x b_z - x a_z)) <= e_z) (z2_near : Rabs (z2 - (x c_z - x a_z)) <= e_z).

(* Denormals may be kept or flushed: errors are at least what projection.v has. *)
Hypotheses (error_in : / 2 ^ 24 <= x error) (error_z_in : / 2 ^ 91 <= x error_z).
Local Notation h := h32.
Lemma h_below_errors : 0 < h <= / 2 ^ 126 /\ h <= / 2 ^ 30 * x error_z /\ h <= / 2 ^ 30 * x error /\
  0 <= x error * x error /\ / 2 ^ 115 <= x error * x error_z /\ / 2 ^ 48 <= x error * x error.
Proof.
  assert (h0 := h32_powers). assert (E := Rmult_le_compat (/ 2 ^ 24) (x error) (/ 2 ^ 91) (x error_z) ltac:(lra) ltac:(lra)
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

Theorem n_x_near v : computes32 x n_x v -> Rabs ((y1 * z2 - z1 * y2) - v) <= (1 + / 256) * real x delta_x.
Proof. intros C. near y1_near z2_near z1_near y2_near v C n_x. errors_are_positive. lra. Qed.
Theorem n_y_near v : computes32 x n_y v -> Rabs ((z1 * x2 - x1 * z2) - v) <= (1 + / 256) * real x delta_y.
Proof. intros C. near z1_near x2_near x1_near z2_near v C n_y. errors_are_positive. lra. Qed.
Theorem n_z_near v : computes32 x n_z v -> Rabs ((x1 * y2 - y1 * x2) - v) <= (1 + / 256) * real x delta_z.
Proof. intros C. near x1_near y2_near y1_near x2_near v C n_z. errors_are_positive. lra. Qed.
End Plane.

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

(* What the margin multiplies with 1.01 has only positive terms, so that it is computed at least at this much of its
  size;
   the quotients have met 5 roundings more each. *)
Definition deepest := (roundings margin + roundings quotient_4_over + roundings quotient_4_under + 10)%nat.
Lemma inflation_is_enough : Qle_bool (1 + (1 # 2 ^ 8)) (inflation * (1 - alphaQ u32Q deepest)) = true.
Proof. vm_compute. reflexivity. Qed.

Definition constants := Eval vm_compute in shown least_bound of_largest.
Print constants.
Definition checked := (rounding, n_x_near, n_y_near, n_z_near, plane_moves, inflation_is_enough).
Print Assumptions checked.
