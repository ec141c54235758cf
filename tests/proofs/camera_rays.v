(* SPDX-License-Identifier: MIT *)
(* camera_rays.clh and det3.clh: determinants whose last row is a camera's ray, which floats hold only to some roundings; each
   coordinate has a size beside it (docs/numerics.md, 9).
     ray_near, in_picture_near   from the table and from the position in the picture, a coordinate is off by at most u (1 +
                                 2^-20) times its size, and 2^-110;
     det_near                    so det3's bound holds for the sizes in place of the coordinates.

   Assumed: a low part is at most half an ulp of its high part; a position in the picture is 0 or from 2^-7 to 2^14 (whole
   numbers of 1 / SAMPLE_UNITS; no side has more pixels); the picture's three vectors are rounded once, and its rays are
   within 2^-46 of the table's; no size and no difference exceeds 1048577 (det3_float() compares what it computed with
   2^20), and Q is 2^-40 at least. Denormals may be kept or flushed. In prose: the double level, whose sizes are doubled for
   one rounding more. Overflow: nothing exceeds 2^66. *)
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

Local Notation lost_of_ray := (/ 1298074214633706907132624082305024).  (* 2^-110 *)

Section Rays.
Variable x : nat -> R.
Local Notation computed := (computes32 x).
Definition times : Q := match ray_size with Times c _ => c | _ => 0%Q end.
Definition times_in_picture : Q := match picture_size with Times c _ => c | _ => 0%Q end.

Variables column_low row_low : R.  (* of the table, left out in float *)
Definition real_ray := x column_high_x + column_low + (x row_high_x + row_low).
Definition least_times : Q := 19999995 # 10000000.
Let low_part low high := Rabs low <= u * Rabs high + h32.
Theorem ray_near r s c : low_part column_low (x column_high_x) -> low_part row_low (x row_high_x) ->
  computed ray r -> computed (Times c (Add (Abs (Given column_high_x 0)) (Abs (Given row_high_x 0)))) s ->
  Q2R least_times <= Q2R c -> Q2R c <= 4 -> Rabs (r - real_ray) <= u * more * s + lost_of_ray.
Proof.
  unfold low_part. intros Hc Hr C Cs enough small. apply near32 in Cs. apply near32 in C. unfold lost32 in C, Cs.
  cbn -[u32 h32 alpha Q2R] in C, Cs. rewrite !u32_value in C, Cs. assert (h := h32_positive). assert (h1 := h32_below).
  simpl in h1. assert (A := alpha_below 1 ltac:(lia)). assert (A' := alpha_below 2 ltac:(lia)). simpl INR in A, A'.
  rewrite u32_value in A, A'. set (P := Rabs (x column_high_x) + Rabs (x row_high_x)) in *.
  assert (P0 : 0 <= P) by (unfold P; apply Rplus_le_le_0_compat; apply Rabs_pos).
  replace (Q2R least_times) with (19999995 / 10000000) in enough by (unfold Q2R, least_times; simpl; lra).
  rewrite (Rabs_pos_eq (Q2R c)) in Cs by lra. assert (E := Rmult_le_compat_r P _ _ P0 A).
  assert (cP := Rmult_le_compat_r P _ _ P0 enough). assert (cP0 : 0 <= Q2R c * P) by (apply Rmult_le_pos; lra).
  assert (ch : Q2R c * h32 <= 4 * h32) by (apply Rmult_le_compat_r; lra). assert (ch0 : 0 <= Q2R c * h32) by (apply
    Rmult_le_pos; lra).
  assert (E' := Rmult_le_compat_r (Q2R c * P) _ _ cP0 A'). apply between in Hc, Hr, C, Cs. unfold real_ray.
  apply Rabs_le. unfold P in *. lra.
Qed.

Variables C_0 S_x S_y : R.  (* the picture's vectors before they are rounded *)
Variable R_0 : R.           (* the ray of the table *)
Let once v V := Rabs (v - V) <= u * Rabs v + / 4 * h32.
Definition real_place := C_0 + x X * S_x + x Y * S_y.
Definition least_in_picture : Q := 301 # 100.
Let place i := x i = 0 \/ / 128 <= x i <= 16384.
(* A place is no denormal, so that no device flushes it. *)
Definition may_lose (i : nat) : Q := if (Nat.eqb i X || Nat.eqb i Y)%bool then 0 else h32Q.
Definition at_most (i : nat) : polynomial := number (if (Nat.eqb i X || Nat.eqb i Y)%bool then 16384 else any).
Definition places_are_kept : place X -> place Y -> keeps x may_lose.
Proof.
  intros PX PY i. assert (h := h32_below). simpl in h. unfold may_lose. destruct (Nat.eqb_spec i X) as [-> |];
    [| destruct (Nat.eqb_spec i Y) as [-> |]; [| now left]]; right; (split; [reflexivity |]); [destruct PX as [P | P] |
    destruct PY as [P | P]]; auto; right; rewrite Rabs_pos_eq; lra.
Qed.
Definition size_of c := Times c (Add (Add (Abs (Given corner 0)) (Mul (Abs (Given step_x 0)) (Given X 0)))
    (Mul (Abs (Given step_y 0)) (Given Y 0))).
Theorem in_picture_near v s c : place X -> place Y -> once (x corner) C_0 -> once (x step_x) S_x -> once (x step_y) S_y ->
  Rabs (x corner) <= Q2R any -> Rabs (x step_x) <= Q2R any -> Rabs (x step_y) <= Q2R any ->
  Rabs (R_0 - real_place) <= / 70368744177664 * (Rabs (x corner) + Rabs (x step_x) * x X + Rabs (x step_y) * x Y) ->
  computed in_picture v -> computed (size_of c) s -> Q2R least_in_picture <= Q2R c -> c = times_in_picture ->
  Rabs (v - R_0) <= u * more * s + lost_of_ray.
Proof.
  unfold once. intros PX PY Hc Hx Hy LC LX LY Hr C Cs enough is_kernels. subst c.
  assert (K := places_are_kept PX PY). assert (XY : 0 <= x X <= 16384 /\ 0 <= x Y <= 16384).
  { destruct PX as [-> | ?], PY as [-> | ?]; lra. } destruct XY as [[X0 X1] [Y0 Y1]].
  assert (W : forall e, e = in_picture \/ e = size_of times_in_picture -> within x (fun i => at_size 1 (at_most i))
    (fun _ _ => 0) e).
  { assert (V : forall i, Rabs (x i) <= Q2R any -> Nat.eqb i X = false -> Nat.eqb i Y = false -> Rabs (x i) <= at_size 1
      (at_most i)) by (intros i H N1 N2; unfold at_most; rewrite N1, N2; cbn -[Q2R any]; lra).
    assert (VX : Rabs (x X) <= at_size 1 (at_most X)) by (rewrite Rabs_pos_eq by lra; unfold at_most; cbn; unfold Q2R;
      simpl; lra).
    assert (VY : Rabs (x Y) <= at_size 1 (at_most Y)) by (rewrite Rabs_pos_eq by lra; unfold at_most; cbn; unfold Q2R;
      simpl; lra).
    intros e [-> | ->]; cbn [in_picture size_of within]; repeat split; auto. }
  apply (near_at_size_keeping x may_lose at_most (fun _ _ => nil) 1 (number (33000 # 85070591730234615865843651857942052864)) in_picture _ K ltac:(lra)
    ltac:(vm_compute; reflexivity) (W _ (or_introl eq_refl))) in C.
  apply (near_at_size_keeping x may_lose at_most (fun _ _ => nil) 1 (number (1 # 1267650600228229401496703205376)) (size_of times_in_picture) _ K
    ltac:(lra) ltac:(vm_compute; reflexivity) (W _ (or_intror eq_refl))) in Cs.
  set (c := times_in_picture) in *. cbn -[u32 alpha Q2R c] in C, Cs. rewrite ?Rmult_0_r, ?Rplus_0_r in C, Cs.
  replace (Q2R (33000 # 85070591730234615865843651857942052864)) with (33000 / 85070591730234615865843651857942052864) in C by (unfold Q2R; simpl; lra).
  replace (Q2R (1 # 1267650600228229401496703205376)) with (/ 1267650600228229401496703205376) in Cs by (unfold Q2R; simpl; lra).
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  assert (A := alpha_below 2 ltac:(lia)). assert (A' := alpha_below 4 ltac:(lia)). simpl INR in A, A'.
  rewrite (Rabs_pos_eq (x X)), (Rabs_pos_eq (x Y)) in C, Cs by assumption.
  assert (Gx := Rmult_le_compat_r _ _ _ X0 Hx). assert (Gy := Rmult_le_compat_r _ _ _ Y0 Hy).
  rewrite <- (Rabs_pos_eq (x X)) in Gx at 1 by assumption. rewrite <- (Rabs_pos_eq (x Y)) in Gy at 1 by assumption.
  rewrite <- Rabs_mult in Gx, Gy.
  assert (hX := Rmult_le_compat_l h32 _ _ ltac:(lra) X1). assert (hY := Rmult_le_compat_l h32 _ _ ltac:(lra) Y1).
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
Let near_size w s W := Rabs (x w - W) <= u * more * x s + lost_of_ray /\ Rabs (x w) <= x s + lost_of_ray.
Hypotheses (w_x_near : near_size w_x size_w_x W_x) (w_y_near : near_size w_y size_w_y W_y) (w_z_near : near_size w_z
  size_w_z W_z).
Hypotheses (x0 : 0 <= x size_w_x) (y0 : 0 <= x size_w_y) (z0 : 0 <= x size_w_z).
Let minor i j k l m n o p := (x i - x j) * (x k - x l) - (x m - x n) * (x o - x p).
Let sizes i j k l m n o p := Rabs (x i - x j) * Rabs (x k - x l) + Rabs (x m - x n) * Rabs (x o - x p).
Let apart_in i j := Rabs (x i - x j) <= 1048577.
Hypotheses (u_x : apart_in u1_x u0_x) (u_y : apart_in u1_y u0_y) (u_z : apart_in u1_z u0_z).
Hypotheses (v_x : apart_in v1_x v0_x) (v_y : apart_in v1_y v0_y) (v_z : apart_in v1_z v0_z).
Hypotheses (s_x : Rabs (x size_w_x) <= 1048577) (s_y : Rabs (x size_w_y) <= 1048577) (s_z : Rabs (x size_w_z) <=
  1048577).
Definition real_det := W_x * minor u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y + W_y * minor u1_z u0_z v1_x v0_x u1_x u0_x
  v1_z v0_z +
  W_z * minor u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x.
Lemma sizes0 i j k l m n o p : 0 <= sizes i j k l m n o p.
Proof. apply Rplus_le_le_0_compat; apply Rmult_le_pos; apply Rabs_pos. Qed.
Lemma sizes1 i j k l m n o p : apart_in i j -> apart_in k l -> apart_in m n -> apart_in o p ->
  sizes i j k l m n o p <= 2200000000000.
Proof.
  unfold apart_in, sizes. intros A B C D.
  assert (E := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) A B).
  assert (F := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) C D). lra.
Qed.
Lemma minor_below i j k l m n o p : Rabs (minor i j k l m n o p) <= sizes i j k l m n o p.
Proof.
  unfold minor, sizes, Rminus at 1. eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, !Rabs_mult. lra.
Qed.
Lemma term w s W i j k l m n o p : near_size w s W -> sizes i j k l m n o p <= 2200000000000 ->
  Rabs (x w * minor i j k l m n o p - W * minor i j k l m n o p) <= u * more * (x s * sizes i j k l m n o p) +
    lost_of_ray * 2200000000000 /\
  Rabs (x w) * sizes i j k l m n o p <= x s * sizes i j k l m n o p + lost_of_ray * 2200000000000.
Proof.
  intros [N I] M. assert (Z := sizes0 i j k l m n o p).
  split; [| assert (G := Rmult_le_compat_r _ _ _ Z I); lra].
  replace (x w * minor i j k l m n o p - W * minor i j k l m n o p) with ((x w - W) * minor i j k l m n o p) by ring.
  rewrite Rabs_mult. assert (G := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N (minor_below i j k l m n o p)). lra.
Qed.

Definition least_bound : Q := 80001 # 167772160000.
Theorem det_near v s t b c : computes32 x value v -> computes32 x size s -> / 1099511627776 <= s -> seen32 s t ->
  rounds32 (Q2R c * t) b -> Q2R least_bound + u / 10 <= Q2R c <= 1 -> Rabs (v - real_det) <= b.
Proof.
  intros C Cs s_least St Rb Hc. assert (A := alpha_below 7 ltac:(lia)). simpl INR in A.
  assert (w_in : forall w s W, near_size w s W -> Rabs (x s) <= 1048577 -> Rabs (x w) <= 1048578).
  { intros w s' W [_ I] J. apply between in J. lra. }
  assert (wx := w_in _ _ _ w_x_near s_x). assert (wy := w_in _ _ _ w_y_near s_y). assert (wz := w_in _ _ _ w_z_near s_z).
  unfold apart_in in *.
  assert (limits : Q2R 1048578 = 1048578) by (unfold Q2R; simpl; lra).
  assert (Lv : limited32 1048578 x value v).
  { split; [exact C |]. unfold within_limits. cbn -[Q2R]. rewrite limits. repeat split; lra. }
  assert (Ls : limited32 1048578 x size s).
  { split; [exact Cs |]. unfold within_limits. cbn -[Q2R]. rewrite limits. repeat split; lra. }
  clear C Cs w_in wx wy wz.
  near_in 1048578%Q (1 # 302231454903657293676544) value Lv. near_in 1048578%Q (1 # 302231454903657293676544) size Ls.
  replace (Q2R (1 # 302231454903657293676544)) with (/ 302231454903657293676544) in Lv, Ls by (unfold Q2R; simpl; lra).
  cbn -[u32 alpha] in Lv, Ls.
  rewrite !(Rabs_pos_eq (x size_w_x)), !(Rabs_pos_eq (x size_w_y)), !(Rabs_pos_eq (x size_w_z)), !Rabs_mult in Ls by
    assumption.
  assert (M1 := sizes1 u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y u_y v_z u_z v_y).
  assert (M2 := sizes1 u1_z u0_z v1_x v0_x u1_x u0_x v1_z v0_z u_z v_x u_x v_z).
  assert (M3 := sizes1 u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x u_x v_y u_y v_x).
  destruct (term _ _ _ u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y w_x_near M1) as [N1 I1].
  destruct (term _ _ _ u1_z u0_z v1_x v0_x u1_x u0_x v1_z v0_z w_y_near M2) as [N2 I2].
  destruct (term _ _ _ u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x w_z_near M3) as [N3 I3].
  assert (T := fun i j k l m n o p s (H : 0 <= x s) => Rmult_le_pos _ _ H (sizes0 i j k l m n o p)).
  assert (T1 := T u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y _ x0).
  assert (T2 := T u1_z u0_z v1_x v0_x u1_x u0_x v1_z v0_z _ y0).
  assert (T3 := T u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x _ z0). clear T.
  unfold real_det. fold (minor u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y) in Lv.
  set (S := x size_w_x * sizes u1_y u0_y v1_z v0_z u1_z u0_z v1_y v0_y + x size_w_y * sizes u1_z u0_z v1_x v0_x u1_x u0_x
    v1_z v0_z +
    x size_w_z * sizes u1_x u0_x v1_y v0_y u1_y u0_y v1_x v0_x) in *.
  assert (S0 : 0 <= S) by (unfold S; lra).
  match type of Ls with Rabs (_ - ?r) <= _ * ?p + _ => replace r with S in Ls by (unfold S, sizes; ring);
    replace p with S in Ls by (unfold S, sizes; ring) end.
  match type of Lv with _ <= _ * ?p + _ => set (P := p) in * end.
  assert (P0 : 0 <= P) by (assert (Z := permanent_positive x value); exact Z).
  assert (P1 : P <= S + 3 * (lost_of_ray * 2200000000000)) by (unfold P, S, sizes in *; lra).
  assert (E := Rmult_le_compat _ _ _ _ (alpha_at_least 7) P0 A P1). assert (E' := Rmult_le_compat_r _ _ _ S0 A).
  (* The bound, as it is computed. *)
  apply seen32_near in St. apply one_rounding32 in Rb. assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  replace (Q2R least_bound) with (80001 / 10000 * u) in Hc by (unfold Q2R, least_bound; simpl; lra).
  apply between in N1, N2, N3, Lv, Ls, St. assert (t0 : 0 <= t) by lra.
  assert (ct := Rmult_le_compat_r t _ _ t0 (proj1 Hc)). assert (ct0 : 0 <= Q2R c * t) by lra.
  rewrite (Rabs_pos_eq (Q2R c * t)) in Rb by lra. apply between in Rb.
  apply Rabs_le. unfold minor in *. unfold S in *. lra.
Qed.
End Determinant.
Lemma kernels_are_enough : (least_times <= times /\ least_in_picture <= times_in_picture /\ least_bound + (1 # 167772160) <=
  bound_constant)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_bound bound_constant.
Print constants.
Definition rests := Eval vm_compute in shown least_in_picture times_in_picture.
Print rests.
Definition checked := (ray_near, in_picture_near, det_near, kernels_are_enough).
Print Assumptions checked.
