(* SPDX-License-Identifier: MIT *)
(* camera_rays.clh and det3.clh: determinants whose last row is a camera's ray, which floats hold only to some roundings; each
   coordinate has a size beside it (docs/numerics.md, 9).
     ray_near, in_picture_near   from the table and from the position in the picture, a coordinate is off by at most u (1 +
                                 2^-20) times its size;
     det_near                    so det3's bound holds for the sizes in place of the coordinates.

   Assumed: a low part is at most half an ulp of its high part; a position in the picture is not negative; the picture's
   three vectors are rounded once, and its rays are within 2^-46 of the table's; no result is below 2^-126 unless it is 0
   (det3_float.v has what underflow takes). In prose: the double level, whose sizes are doubled for one rounding more.
   Overflow: nothing exceeds 2^66. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition column_high_x := 0%nat.
Definition row_high_x := 1%nat.
Definition corner := 2%nat.
Definition step_x := 3%nat.
Definition step_y := 4%nat.
Definition X := 5%nat.
Definition Y := 6%nat.
Definition u1_x := 7%nat.
Definition u1_y := 8%nat.
Definition u1_z := 9%nat.
Definition u0_x := 10%nat.
Definition u0_y := 11%nat.
Definition u0_z := 12%nat.
Definition v1_x := 13%nat.
Definition v1_y := 14%nat.
Definition v1_z := 15%nat.
Definition v0_x := 16%nat.
Definition v0_y := 17%nat.
Definition v0_z := 18%nat.
Definition w_x := 19%nat.
Definition w_y := 20%nat.
Definition w_z := 21%nat.
Definition size_w_x := 22%nat.
Definition size_w_y := 23%nat.
Definition size_w_z := 24%nat.
Definition ray :=
  Add (Given column_high_x 0) (Given row_high_x 0).
Definition ray_size :=
  Times (2 # 1) (Add (Abs (Given column_high_x 0)) (Abs (Given row_high_x 0))).
Definition in_picture :=
  Fma (Given X 0) (Given step_x 0) (Fma (Given Y 0) (Given step_y 0) (Given corner 0)).
Definition picture_size :=
  Times (4 # 1) (Add (Add (Abs (Given corner 0)) (Mul (Abs (Given step_x 0)) (Given X 0))) (Mul (Abs (Given step_y
    0)) (Given Y 0))).
Definition value :=
  Add (Add (Mul (Given w_x 0) (Sub (Mul (Diff u1_y u0_y) (Diff v1_z v0_z)) (Mul (Diff u1_z u0_z) (Diff v1_y v0_y))))
    (Mul (Given w_y 0) (Sub (Mul (Diff u1_z u0_z) (Diff v1_x v0_x)) (Mul (Diff u1_x u0_x) (Diff v1_z v0_z))))) (Mul
    (Given w_z 0) (Sub (Mul (Diff u1_x u0_x) (Diff v1_y v0_y)) (Mul (Diff u1_y u0_y) (Diff v1_x v0_x)))).
Definition size :=
  Add (Add (Mul (Add (Abs (Mul (Diff u1_x u0_x) (Diff v1_z v0_z))) (Abs (Mul (Diff u1_z u0_z) (Diff v1_x v0_x))))
    (Given size_w_y 0)) (Mul (Add (Abs (Mul (Diff u1_y u0_y) (Diff v1_z v0_z))) (Abs (Mul (Diff u1_z u0_z) (Diff
    v1_y v0_y)))) (Given size_w_x 0))) (Mul (Add (Abs (Mul (Diff u1_x u0_x) (Diff v1_y v0_y))) (Abs (Mul (Diff u1_y
    u0_y) (Diff v1_x v0_x)))) (Given size_w_z 0)).
(* bound: where max(size_w_x, max(abs(sub(u1_x, u0_x)), abs(sub(v1_x, v0_x)))) <= 1048576.0 *)
(* bound: where max(size_w_y, max(abs(sub(u1_y, u0_y)), abs(sub(v1_y, v0_y)))) <= 1048576.0 *)
(* bound: where max(size_w_z, max(abs(sub(u1_z, u0_z)), abs(sub(v1_z, v0_z)))) <= 1048576.0 *)
(* bound: where size >= 9.094947017729282e-13 *)
(* bound = bound_constant * size *)
Definition bound_constant : Q := 8796093 # 17592186044416.
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation more := (1 + / 1048576).

Section Rays.
Variable x : nat -> R.
Definition times : Q := match ray_size with Times c _ => c | _ => 0%Q end.
Definition times_in_picture : Q := match picture_size with Times c _ => c | _ => 0%Q end.

Variables column_low row_low : R.  (* of the table, left out in float *)
Definition real_ray := x column_high_x + column_low + (x row_high_x + row_low).
Definition least_times : Q := 19999995 # 10000000.
Theorem ray_near r s c : Rabs column_low <= u * Rabs (x column_high_x) -> Rabs row_low <= u * Rabs (x row_high_x) ->
  computed x ray r -> computed x (Times c (Add (Abs (Given column_high_x 0)) (Abs (Given row_high_x 0)))) s ->
  Q2R least_times <= Q2R c -> Rabs (r - real_ray) <= u * more * s.
Proof.
  intros Hc Hr C Cs enough. apply near in Cs. apply near in C. cbn -[u32 alpha Q2R] in C, Cs.
  assert (A := alpha_below 1 ltac:(lia)). assert (A' := alpha_below 2 ltac:(lia)). simpl INR in A, A'.
  set (P := Rabs (x column_high_x) + Rabs (x row_high_x)) in *.
  assert (P0 : 0 <= P) by (unfold P; apply Rplus_le_le_0_compat; apply Rabs_pos).
  replace (Q2R least_times) with (19999995 / 10000000) in enough by (unfold Q2R, least_times; simpl; lra).
  rewrite (Rabs_pos_eq (Q2R c)) in Cs by lra. assert (E := Rmult_le_compat_r P _ _ P0 A).
  assert (cP := Rmult_le_compat_r P _ _ P0 enough). assert (cP0 : 0 <= Q2R c * P) by (apply Rmult_le_pos; lra).
  assert (E' := Rmult_le_compat_r (Q2R c * P) _ _ cP0 A'). apply between in Hc, Hr, C, Cs. unfold real_ray.
  apply Rabs_le. unfold P in *. lra.
Qed.

Variables C_0 S_x S_y : R.  (* the picture's vectors before they are rounded *)
Variable R_0 : R.           (* the ray of the table *)
Let once v V := Rabs (v - V) <= u * Rabs v.
Definition real_place := C_0 + x X * S_x + x Y * S_y.
Definition least_in_picture : Q := 301 # 100.
Theorem in_picture_near v s c : 0 <= x X -> 0 <= x Y -> once (x corner) C_0 -> once (x step_x) S_x -> once (x step_y) S_y ->
  Rabs (R_0 - real_place) <= / 70368744177664 * (Rabs (x corner) + Rabs (x step_x) * x X + Rabs (x step_y) * x Y) ->
  computed x in_picture v -> computed x (Times c (Add (Add (Abs (Given corner 0)) (Mul (Abs (Given step_x 0)) (Given X 0)))
    (Mul (Abs (Given step_y 0)) (Given Y 0)))) s -> Q2R least_in_picture <= Q2R c -> Rabs (v - R_0) <= u * more * s.
Proof.
  unfold once. intros X0 Y0 Hc Hx Hy Hr C Cs enough. apply near in Cs. apply near in C. cbn -[u32 alpha Q2R] in C, Cs.
  assert (A := alpha_below 2 ltac:(lia)). assert (A' := alpha_below 4 ltac:(lia)). simpl INR in A, A'.
  rewrite (Rabs_pos_eq (x X)), (Rabs_pos_eq (x Y)) in C, Cs by assumption.
  assert (Gx := Rmult_le_compat_r _ _ _ X0 Hx). assert (Gy := Rmult_le_compat_r _ _ _ Y0 Hy).
  rewrite <- (Rabs_pos_eq (x X)) in Gx at 1 by assumption. rewrite <- (Rabs_pos_eq (x Y)) in Gy at 1 by assumption.
  rewrite <- Rabs_mult in Gx, Gy.
  assert (px : 0 <= Rabs (x step_x) * x X) by (apply Rmult_le_pos; auto using Rabs_pos).
  assert (py : 0 <= Rabs (x step_y) * x Y) by (apply Rmult_le_pos; auto using Rabs_pos). assert (pc := Rabs_pos (x corner)).
  set (P := Rabs (x corner) + Rabs (x step_x) * x X + Rabs (x step_y) * x Y) in *.
  replace (x X * Rabs (x step_x) + (x Y * Rabs (x step_y) + Rabs (x corner))) with P in C by (unfold P; ring).
  assert (P0 : 0 <= P) by (unfold P; lra).
  replace (Q2R least_in_picture) with (301 / 100) in enough by (unfold Q2R, least_in_picture; simpl; lra).
  rewrite (Rabs_pos_eq (Q2R c)) in Cs by lra. assert (E := Rmult_le_compat_r P _ _ P0 A).
  assert (cP := Rmult_le_compat_r P _ _ P0 enough). assert (cP0 : 0 <= Q2R c * P) by (apply Rmult_le_pos; lra).
  assert (E' := Rmult_le_compat_r (Q2R c * P) _ _ cP0 A'). apply between in Hc, Gx, Gy, Hr, C, Cs. unfold real_place in *.
  apply Rabs_le. unfold P in *. lra.
Qed.
End Rays.

Section Determinant.
Variable x : nat -> R.
Variables W_x W_y W_z : R.
Let near_size w s W := Rabs (x w - W) <= u * more * x s /\ Rabs (x w) <= x s.
Hypotheses (w_x_near : near_size w_x size_w_x W_x) (w_y_near : near_size w_y size_w_y W_y) (w_z_near : near_size w_z
  size_w_z W_z).
Let minor i j k l m n o p := (x i - x j) * (x k - x l) - (x m - x n) * (x o - x p).
Let sizes i j k l m n o p := Rabs (x i - x j) * Rabs (x k - x l) + Rabs (x m - x n) * Rabs (x o - x p).
Definition real_det := W_x * minor u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y + W_y * minor u1_z u0_z v1_x v0_x u1_x u0_x
  v1_z v0_z +
  W_z * minor u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x.
Lemma sizes0 i j k l m n o p : 0 <= sizes i j k l m n o p.
Proof. apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos. Qed.
Lemma minor_below i j k l m n o p : Rabs (minor i j k l m n o p) <= sizes i j k l m n o p.
Proof.
  unfold minor, sizes, Rminus at 1. eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, !Rabs_mult. lra.
Qed.
Lemma term w s W i j k l m n o p : near_size w s W ->
  Rabs (x w * minor i j k l m n o p - W * minor i j k l m n o p) <= u * more * (x s * sizes i j k l m n o p) /\
  Rabs (x w) * sizes i j k l m n o p <= x s * sizes i j k l m n o p.
Proof.
  intros [N I]. assert (Z := sizes0 i j k l m n o p). split; [| apply Rmult_le_compat_r; assumption].
  replace (x w * minor i j k l m n o p - W * minor i j k l m n o p) with ((x w - W) * minor i j k l m n o p) by ring.
  rewrite Rabs_mult. assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N (minor_below i j k l m n o p)). lra.
Qed.

Definition least_bound : Q := 80001 # 167772160000.
Theorem det_near v s : computed x value v -> computed x size s -> Rabs (v - real_det) <= (1 - u) * (Q2R least_bound * s).
Proof.
  intros C Cs. apply near in C. apply near in Cs. assert (A := alpha_below 7 ltac:(lia)). simpl INR in A.
  assert (s0 : 0 <= x size_w_x /\ 0 <= x size_w_y /\ 0 <= x size_w_z).
  { repeat split; eapply Rle_trans; try apply Rabs_pos; [apply w_x_near | apply w_y_near | apply w_z_near]. }
  destruct s0 as (x0 & y0 & z0). cbn -[u32 alpha] in C, Cs.
  rewrite !(Rabs_pos_eq (x size_w_x)), !(Rabs_pos_eq (x size_w_y)), !(Rabs_pos_eq (x size_w_z)), !Rabs_mult in Cs by
    assumption.
  destruct (term _ _ _ u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y w_x_near) as [N1 I1].
  destruct (term _ _ _ u1_z u0_z v1_x v0_x u1_x u0_x v1_z v0_z w_y_near) as [N2 I2].
  destruct (term _ _ _ u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x w_z_near) as [N3 I3].
  assert (T := fun i j k l m n o p s (H : 0 <= x s) => Rmult_le_pos _ _ H (sizes0 i j k l m n o p)).
  assert (T1 := T u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y _ x0).
  assert (T2 := T u1_z u0_z v1_x v0_x u1_x u0_x v1_z v0_z _ y0).
  assert (T3 := T u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x _ z0). clear T.
  replace (Q2R least_bound) with (80001 / 10000 * u) by (unfold Q2R, least_bound; simpl; lra).
  unfold real_det. fold (minor u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y) in C.
  set (S := x size_w_x * sizes u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y + x size_w_y * sizes u1_z u0_z v1_x v0_x u1_x u0_x
    v1_z v0_z +
    x size_w_z * sizes u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x) in *.
  assert (S0 : 0 <= S) by (unfold S; lra).
  match type of Cs with Rabs (_ - ?r) <= _ * ?p => replace r with S in Cs by (unfold S, sizes; ring);
    replace p with S in Cs by (unfold S, sizes; ring) end.
  match type of C with _ <= _ * ?p => set (P := p) in * end.
  assert (P0 : 0 <= P) by (assert (Z := permanent_positive x value); exact Z).
  assert (P1 : P <= S) by (unfold P, S, sizes in *; lra).
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 7) P0 A P1). assert (E' := Rmult_le_compat_r _ _ _ S0 A).
  apply between in N1, N2, N3, C, Cs. apply Rabs_le. unfold minor in *. unfold S in *. lra.
Qed.
End Determinant.

Lemma kernels_are_enough : (least_times <= times /\ least_in_picture <= times_in_picture /\ least_bound <=
  bound_constant)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_bound bound_constant.
Print constants.
Definition rests := Eval vm_compute in shown least_in_picture times_in_picture.
Print rests.
Definition checked := (ray_near, in_picture_near, det_near, kernels_are_enough).
Print Assumptions checked.
