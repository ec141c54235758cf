(* SPDX-License-Identifier: MIT *)
(* prepared_light.h: a point whose raw grid coordinate, moved towards the triangles, is beyond their moved bounds is
   beyond each triangle, so that it is lit (docs/numerics.md, 6).
     raw_near           a raw coordinate under a direction is off by 3.1 u of the sum of the coordinates;
     outside_is_beyond  so what is computed to be beyond is beyond (the other sides have the same terms);
     ratio_near         a ratio of a point light is off by 9.1 u of itself, of at most 1 and 2 u, and by 2.1 u.

   Assumed: the shear is the slope, rounded once, and at most 1; triangles have no coordinate above `largest`, and
   `high` is the greatest of their computed raw coordinates; a quotient is off by 2.5 ulp; a point light is at least
   2^-101 away along a face's axis (SMALLEST_W times itself, by 2: make_perspective()). Denormals may be kept or
   flushed: PREPARED_UNDERFLOW covers what that takes. Overflow: coordinates are below 1e30.
   loose: both paddings are the fit's (frame_fit.v), so that what is not lit stays within what the fit is made for. *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition point_x := 0%nat.
Definition point_y := 1%nat.
Definition point_z := 2%nat.
Definition shear_x := 3%nat.
Definition light_x := 4%nat.
Definition light_z := 5%nat.
Definition high := 6%nat.
Definition largest := 7%nat.
Definition quotient_1 := 8%nat.
Definition raw :=
  Sub (Given point_x 0) (Mul (Given point_z 0) (Given shear_x 0)).
Definition moved :=
  Sub raw (Add (Const (1 # 1329227995784915872903807060280344576)) (Times (1 # 524288) (Add (Abs (Given point_z 0))
    (Add (Abs (Given point_x 0)) (Abs (Given point_y 0)))))).
Definition lit_high :=
  Add (Add (Const (1 # 1329227995784915872903807060280344576)) (Times (1 # 524288) (Given largest 0))) (Given high
    0).
Definition quotient_1_over :=
  Diff point_x light_x.
Definition quotient_1_under :=
  Diff point_z light_z.
Definition ratio := Given quotient_1 0.
Definition smallest :=
  Const (9444733 # 9444732965739290427392).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation computed := computes32.
Definition shared := 99%nat.  (* the computed raw coordinate *)
Definition least_bit : Q := 1 # 1329227995784915872903807060280344576.
Definition sum := Add (Abs (Given point_z 0)) (Add (Abs (Given point_x 0)) (Abs (Given point_y 0))).
Definition moved_by a c := Sub a (Add (Const least_bit) (Times c sum)).
Definition high_by c := Add (Add (Const least_bit) (Times c (Given largest 0))) (Given high 0).
Definition of_points : Q := match moved with Sub _ (Add _ (Times c _)) => c | _ => 0%Q end.
Definition of_triangles : Q := match lit_high with Add (Add _ (Times c _)) _ => c | _ => 0%Q end.
Lemma bounds_are : moved = moved_by raw of_points /\ lit_high = high_by of_triangles.
Proof. split; reflexivity. Qed.

Section Direction.
Variable slope : R.
Definition real_raw p_x p_z := p_x - slope * p_z.

Theorem raw_near x r : Rabs (x shear_x) <= 1 -> Rabs (x shear_x - slope) <= 101 / 100 * u -> computed x raw r ->
  Rabs (r - real_raw (x point_x) (x point_z)) <= 31 / 10 * u * (Rabs (x point_x) + Rabs (x point_z)) + 9 * h32.
Proof.
  intros g1 Hs C. assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  destruct (step32_sub _ _ _ _ C) as (p & t & Cp & Ct & N1). destruct (step32_mul _ _ _ _ Ct) as (z & g & Cz & Cg & N2).
  apply given32_is in Cp, Cz, Cg. subst p z g.
  assert (X0 := Rabs_pos (x point_x)). assert (Z0 := Rabs_pos (x point_z)).
  assert (G := Rmult_le_compat_l _ _ _ Z0 g1). rewrite <- Rabs_mult in G.
  assert (M := Rmult_le_compat_r _ _ _ Z0 Hs). rewrite <- Rabs_mult in M.
  assert (hz : h32 * Rabs (x point_z) <= / 1000000000000 * Rabs (x point_z)) by (apply Rmult_le_compat_r; lra).
  assert (hg : h32 * Rabs (x shear_x) <= h32 * 1) by (apply Rmult_le_compat_l; lra).
  assert (T1 := Rabs_triang (x point_x) (- t)). rewrite Rabs_Ropp in T1. fold (x point_x - t) in T1.
  assert (T2 := Rabs_triang (t - x point_z * x shear_x) (x point_z * x shear_x)).
  replace (t - x point_z * x shear_x + x point_z * x shear_x) with t in T2 by ring.
  assert (N1' := between _ _ N1). assert (N2' := between _ _ N2). apply between in M. unfold real_raw. apply Rabs_le.
    lra.
Qed.

Definition least_points : Q := 53 # 167772160.
Definition least_triangles : Q := 84 # 167772160.
Variable x : nat -> R.
Hypotheses (g1 : Rabs (x shear_x) <= 1) (slope_near : Rabs (x shear_x - slope) <= 101 / 100 * u).
Hypothesis raw_is : computed x raw (x shared).
(* A corner of a triangle, with its computed raw coordinate, to which raw_near applies as well. *)
Variables V_x V_z r_V : R.
Hypotheses (V_x_in : Rabs V_x <= x largest) (V_z_in : Rabs V_z <= x largest).
Hypotheses (V_near : Rabs (r_V - real_raw V_x V_z) <= 31 / 10 * u * (Rabs V_x + Rabs V_z) + 9 * h32) (V_below : r_V <=
  x high).
Hypothesis high_in : Rabs (x high) <= 201 / 100 * x largest + 9 * h32.
Theorem outside_is_beyond c d m b : Q2R least_points <= Q2R c <= 100 * u -> Q2R least_triangles <= Q2R d <= 100 * u ->
  computed x (moved_by (Given shared 0) c) m -> computed x (high_by d) b -> b < m ->
  real_raw V_x V_z < real_raw (x point_x) (x point_z).
Proof.
  intros Hc Hd Cm Cb H. assert (N := raw_near x _ g1 slope_near raw_is).
  replace (Q2R least_points) with (53 / 10 * u) in Hc by (unfold Q2R, least_points; simpl; lra).
  replace (Q2R least_triangles) with (84 / 10 * u) in Hd by (unfold Q2R, least_triangles; simpl; lra).
  assert (h := h32_positive). assert (h1 := h32_below). simpl in h1.
  set (T := Q2R least_bit) in *. assert (T0 : 63 * h32 <= T) by (unfold T, Q2R, least_bit; simpl; lra).
  assert (T1 : T <= / 1000000) by (unfold T, Q2R, least_bit; simpl; lra).
  set (L := x largest) in *. assert (L0 : 0 <= L) by (assert (Z := Rabs_pos V_x); lra).
  (* The point. *)
  destruct (step32_sub _ _ _ _ Cm) as (r & w & Cr & Cw & Nm). apply given32_is in Cr. subst r. set (r := x shared) in *.
  apply near32 in Cw. unfold lost32 in Cw. cbn -[u32 h32 alpha Q2R] in Cw. rewrite ?u32_value in Cw. fold T in Cw.
  rewrite (Rabs_pos_eq T), (Rabs_pos_eq (Q2R c)) in Cw by lra.
  assert (hc : 0 <= Q2R c * h32 <= h32 * / 10000) by (split; [apply Rmult_le_pos; lra | rewrite Rmult_comm; apply
    Rmult_le_compat_l; lra]).
  set (S := Rabs (x point_z) + (Rabs (x point_x) + Rabs (x point_y))) in *.
  assert (P1 := Rabs_pos (x point_x)). assert (P2 := Rabs_pos (x point_y)). assert (P3 := Rabs_pos (x point_z)).
  assert (S0 : 0 <= S) by (unfold S; lra). assert (cS := Rmult_le_compat_r S _ _ S0 (proj1 Hc)).
  assert (cS2 := Rmult_le_compat_r S _ _ S0 (proj2 Hc)).
  assert (A := alpha_below 4 ltac:(lia)). simpl INR in A. rewrite ?u32_value in *.
  assert (E := Rmult_le_compat_r (T + Q2R c * S) _ _ ltac:(lra) A).
  apply between in Cw, N.
  assert (real_size : Rabs (real_raw (x point_x) (x point_z)) <= 10001 / 10000 * S).
  { unfold real_raw, Rminus. eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, Rabs_mult.
    assert (s1 : Rabs slope <= 10001 / 10000) by (apply between in slope_near; apply between in g1; apply Rabs_le; lra).
    assert (G := Rmult_le_compat_r _ _ _ P3 s1). unfold S. lra. }
  apply between in real_size.
  assert (Sm : Rabs (r - w) <= 1001 / 1000 * S + 2 * T + 20 * h32) by (apply Rabs_le; unfold S in *; lra).
  apply (at_most32 _ _ _ _ Nm) in Sm. apply between in Sm.
  (* The triangles. *)
  destruct (step32_add _ _ _ _ Cb) as (p & top & Cp & Ch & Nb). apply given32_is in Ch. subst top. set (top := x high)
    in *.
  apply near32 in Cp. unfold lost32 in Cp. cbn -[u32 h32 alpha Q2R] in Cp. rewrite ?u32_value in Cp. fold T L in Cp.
  rewrite (Rabs_pos_eq T), (Rabs_pos_eq (Q2R d)), (Rabs_pos_eq L) in Cp by lra.
  assert (hd : 0 <= Q2R d * h32 <= h32 * / 10000) by (split; [apply Rmult_le_pos; lra | rewrite Rmult_comm; apply
    Rmult_le_compat_l; lra]).
  assert (dL := Rmult_le_compat_r L _ _ L0 (proj1 Hd)). assert (dL2 := Rmult_le_compat_r L _ _ L0 (proj2 Hd)).
  assert (B := alpha_below 2 ltac:(lia)). simpl INR in B. rewrite ?u32_value in *.
  assert (F := Rmult_le_compat_r (T + Q2R d * L) _ _ ltac:(lra) B).
  apply between in Cp, high_in. assert (Sb : Rabs (p + top) <= 202 / 100 * L + 2 * T + 20 * h32) by (apply Rabs_le;
    lra).
  apply (at_most32 _ _ _ _ Nb) in Sb. apply between in Sb, V_near. unfold S in *. lra.
Qed.
End Direction.

(* ---- A point light ---- *)
Theorem ratio_near x a b v : computed x quotient_1_over a -> computed x quotient_1_under b -> /
  2535301200456458802993406410752 <= Rabs (x point_z - x light_z) ->
  Rabs (v - a / b) <= 501 / 100 * u * Rabs (a / b) ->
  Rabs (v - (x point_x - x light_x) / (x point_z - x light_z)) <= 91 / 10 * u * Rabs ((x point_x - x light_x) / (x
    point_z - x light_z)) + 21 / 10 * u.
Proof.
  intros Ca Cb W_in Hv. apply step32_diff in Ca, Cb. assert (h1 := h32_below). simpl in h1.
  set (X := x point_x - x light_x) in *. set (W := x point_z - x light_z) in *. assert (W1 : 0 < Rabs W) by lra.
  assert (Ca' : Rabs (a - X) <= u * Rabs X + 2 * u * Rabs W) by lra. assert (Cb' : Rabs (b - W) <= 3 * u * Rabs W) by
    lra.
  assert (W0 : W <> 0) by (intros Z; rewrite Z, Rabs_R0 in W1; lra).
  assert (T := Rabs_triang_inv W (W - b)). replace (W - (W - b)) with b in T by ring.
  rewrite (Rabs_minus_sym W) in T. assert (T' : (1 - 3 * u) * Rabs W <= Rabs b) by lra.
  assert (b0 : b <> 0) by (intros Z; rewrite Z, Rabs_R0 in T'; lra).
  assert (I : Rabs (/ b) <= (1 + 301 / 100 * u) * Rabs (/ W)).
  { rewrite !Rabs_inv. apply Rmult_le_reg_l with (Rabs b); [now apply Rabs_pos_lt |].
    rewrite Rinv_r by (apply Rabs_no_R0; auto). apply Rmult_le_reg_r with (Rabs W); auto.
    rewrite !Rmult_assoc, Rinv_l by (apply Rabs_no_R0; auto). lra. }
  assert (E : Rabs (a / b - X / W) <= 402 / 100 * u * Rabs (X / W) + 201 / 100 * u).
  { replace (a / b - X / W) with ((a - X) * / b + - (X / W * ((b - W) * / b))) by (field; auto).
    eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, !Rabs_mult.
    assert (G1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Ca' I).
    assert (G2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Cb' I).
    replace (3 * u * Rabs W * ((1 + 301 / 100 * u) * Rabs (/ W))) with (3 * u * (1 + 301 / 100 * u)) in G2
      by (rewrite Rabs_inv; field; apply Rabs_no_R0; auto).
    replace ((u * Rabs X + 2 * u * Rabs W) * ((1 + 301 / 100 * u) * Rabs (/ W))) with
      (u * (1 + 301 / 100 * u) * Rabs (X / W) + 2 * u * (1 + 301 / 100 * u)) in G1
      by (unfold Rdiv; rewrite Rabs_mult, Rabs_inv; field; apply Rabs_no_R0; auto).
    assert (G3 := Rmult_le_compat_l _ _ _ (Rabs_pos (X / W)) G2). assert (Z := Rabs_pos (X / W)).
    rewrite <- !Rabs_mult in *. lra. }
  assert (T2 := Rabs_triang (a / b - X / W) (X / W)). replace (a / b - X / W + X / W) with (a / b) in T2 by ring.
  assert (Z := Rabs_pos (X / W)). replace (v - X / W) with ((v - a / b) + (a / b - X / W)) by ring.
  eapply Rle_trans; [apply Rabs_triang |]. lra.
Qed.

Definition smallest_w : Q := match smallest with Const c => c | _ => 0%Q end.
Lemma kernels_are_enough : (least_points <= of_points /\ of_points <= 100 * u32Q /\ least_triangles <= of_triangles /\
  of_triangles <= 100 * u32Q /\ 1 # 2 ^ 101 <= (1 # 2) * smallest_w * smallest_w)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_points of_points.
Print constants.
Definition rests := Eval vm_compute in shown least_triangles of_triangles.
Print rests.
Definition checked := (raw_near, outside_is_beyond, ratio_near, kernels_are_enough).
Print Assumptions checked.
