(* SPDX-License-Identifier: MIT *)
(* triangle_records.clh, set_plane_parallel(): how far a plane's height at a point of the grid may be from the real
  plane's
   at the real point (docs/numerics.md, 4). Three parts, each a theorem:
     rounding              the computed height, from the record's numbers: 20 u L;
     n_x_near and so on    the normal: delta_x, delta_y, delta_z;
     plane_moves           what errors of normal, corner and point do to the height: the margin's quotient and error_z.
   height_error on top is the point's own.

   Assumed: x and y of corners are off by at most `error`, from 2^-24 on, z by error_z, from 2^-91 on (projection.v); |X|,
   |Y|, |a_x| and |a_y| are at most what L multiplies the slopes with, which is from 1 (a bin has a texel) to 2^40 (vertices
   from 1e12 on are out of range); a quotient is off by 2.5 ulp, and a slope by 2^-126 more. Denormals may be kept or flushed:
   what that takes of the normal is less than 2^-8 of the delta, what it takes of the height and of the margin's sums is in
   PLANE_NEAR. In prose: what it takes of the margin's quotient, whose sums are 2^-113 at the least (rho is half a texel at
   least, and delta_x 2^-112), with a delta_z below 3 safe_n_z. `safe_n_z` subtracts 1.01 delta_z and rounds once: at most |n_z| less the real
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

(* What underflow takes of a height, of its slopes and of the margin, and in proportion to L. *)
Lemma kernel_is_enough :
  ((1 # 2 ^ 82) + (1 # 2 ^ 84) + (1 # 2 ^ 96) <= of_nothing * (1 - (1 # 2 ^ 20)) /\
   least_bound + (1 # 2 ^ 100) <= of_largest)%Q.
Proof. vm_compute. split; discriminate. Qed.

Definition constants := Eval vm_compute in shown least_bound of_largest.
Print constants.
Definition checked := (rounding, of_quotients, margin_near, n_x_near, n_y_near, n_z_near, plane_moves, inflation_is_enough,
  kernel_is_enough).
Print Assumptions checked.
