(* SPDX-License-Identifier: MIT *)
(* light_frame.cl: point_error and height_error, the bounds for all points of a frame (docs/numerics.md, 3).
     reach_is_enough      no point is farther from the center than the reach that the bounds are made of;
     coordinate_near      under a direction a coordinate is off by 8.6 u (scale (reach_x + |shear| reach_z) + |offset|),
                          2.5 u of them for what underflow takes;
     height_near          and a height by 4.1 u reach_z and 16 h, which the 2^-90 of each triangle's error_z has: prose;
     ratio_near           of a point light, x / W is off by 4.1 u (scale + |offset|) + 9.6 u texels;
     inverse_near         and 1 / W by 9.1 u of itself.

   Assumed: the shear is the slope, rounded once; the points' coordinates lie between `low` and `high`; a face's points have
   no coordinate that is more than 1 + 2 u times as large as that along its axis, and are inside the grid; a quotient is off
   by 2.5 ulp. Denormals may be kept or flushed: the offset is at least a fifth of a texel, scales are at most 2^76, and 2^36
   over a reach (frame_fit.v: at most 2^16 texels over 64 u M); W is at least 2^-51 (SMALLEST_W), the unit 2^-100; rows are no
   denormals but that of the shear or offset. One entry of each row is 0, here the second; the
   order of the others changes nothing: prose. Overflow: coordinates are below 1e30.
   loose: heights and the point light's scale have the one bound of all rows (not shown: 2.5 times). *)
From Coq Require Import Reals QArith Qreals Lra Psatz.
From Flocq Require Import Core.
Require Import Roundings Devices Filters.

(* begin: from the kernels, by expressions.py *)
Definition point_x := 0%nat.
Definition point_y := 1%nat.
Definition point_z := 2%nat.
Definition center_x := 3%nat.
Definition center_y := 4%nat.
Definition center_z := 5%nat.
Definition raw_low_x := 6%nat.
Definition raw_low_y := 7%nat.
Definition raw_high_x := 8%nat.
Definition raw_high_y := 9%nat.
Definition low_x := 10%nat.
Definition low_y := 11%nat.
Definition low_z := 12%nat.
Definition high_x := 13%nat.
Definition high_y := 14%nat.
Definition high_z := 15%nat.
Definition shear_x := 16%nat.
Definition shear_y := 17%nat.
Definition width := 18%nat.
Definition row := 19%nat.
Definition row_1 := 20%nat.
Definition row_2 := 21%nat.
Definition row_3 := 22%nat.
Definition row_of_heights := 23%nat.
Definition row_of_heights_1 := 24%nat.
Definition row_of_heights_2 := 25%nat.
Definition row_of_heights_3 := 26%nat.
Definition quotient_1 := 27%nat.
Definition greater_1 := 28%nat.
Definition greater_2 := 29%nat.
Definition greater_3 := 30%nat.
Definition greater_4 := 31%nat.
Definition greater_5 := 32%nat.
Definition greater_6 := 33%nat.
Definition greater_7 := 34%nat.
Definition quotient_2 := 35%nat.
Definition greater_8 := 36%nat.
Definition greater_9 := 37%nat.
Definition greater_10 := 38%nat.
Definition quotient_3 := 39%nat.
Definition greater_11 := 40%nat.
Definition greater_12 := 41%nat.
Definition greater_13 := 42%nat.
Definition quotient_4 := 43%nat.
Definition greater_14 := 44%nat.
Definition quotient_5 := 45%nat.
Definition greater_15 := 46%nat.
Definition value :=
  Fma (Given row 0) (Diff point_x center_x) (Fma (Given row_1 0) (Diff point_y center_y) (Fma (Given row_2 0) (Diff
    point_z center_z) (Given row_3 0))).
Definition height :=
  Fma (Given row_of_heights 0) (Diff point_x center_x) (Fma (Given row_of_heights_1 0) (Diff point_y center_y) (Fma
    (Given row_of_heights_2 0) (Diff point_z center_z) (Given row_of_heights_3 0))).
Definition quotient_1_over :=
  value.
Definition quotient_1_under :=
  height.
Definition ratio := Given quotient_1 0.
Definition greater_1_one :=
  Abs (Given high_z 0).
Definition greater_1_other :=
  Abs (Given low_z 0).
Definition greater_2_one :=
  Abs (Given high_y 0).
Definition greater_2_other :=
  Abs (Given low_y 0).
Definition greater_3_one :=
  Abs (Given high_x 0).
Definition greater_3_other :=
  Abs (Given low_x 0).
Definition greater_4_one :=
  Const (0 # 1).
Definition greater_4_other := Given greater_3 0.
Definition greater_5_one := Given greater_2 0.
Definition greater_5_other := Given greater_4 0.
Definition greater_6_one := Given greater_1 0.
Definition greater_6_other := Given greater_5 0.
Definition greater_7_one :=
  Add (Times (2 # 1) (Times (1 # 524288) (Given greater_6 0))) (Diff raw_high_x raw_low_x).
Definition greater_7_other :=
  Const (9671407 # 9671406556917033397649408).
Definition quotient_2_over :=
  Add (Const (-1 # 2)) (Given width 0).
Definition quotient_2_under := Given greater_7 0.
Definition greater_8_one :=
  Abs (Sub (Given high_z 0) (Add (Times (1 # 2) (Given high_z 0)) (Times (1 # 2) (Given low_z 0)))).
Definition greater_8_other :=
  Abs (Sub (Given low_z 0) (Add (Times (1 # 2) (Given high_z 0)) (Times (1 # 2) (Given low_z 0)))).
Definition greater_9_one :=
  Abs (Sub (Given high_x 0) (Add (Times (1 # 2) (Given high_x 0)) (Times (1 # 2) (Given low_x 0)))).
Definition greater_9_other :=
  Abs (Sub (Given low_x 0) (Add (Times (1 # 2) (Given high_x 0)) (Times (1 # 2) (Given low_x 0)))).
Definition greater_10_one :=
  Add (Times (2 # 1) (Times (1 # 524288) (Given greater_6 0))) (Diff raw_high_y raw_low_y).
Definition greater_10_other :=
  greater_7_other.
Definition quotient_3_over :=
  quotient_2_over.
Definition quotient_3_under := Given greater_10 0.
Definition greater_11_one :=
  Abs (Sub (Given high_y 0) (Add (Times (1 # 2) (Given high_y 0)) (Times (1 # 2) (Given low_y 0)))).
Definition greater_11_other :=
  Abs (Sub (Given low_y 0) (Add (Times (1 # 2) (Given high_y 0)) (Times (1 # 2) (Given low_y 0)))).
Definition greater_12_one :=
  Add (Abs (Sub (Const (1 # 4)) (Mul (Given quotient_2 0) (Sub (Sub (Given raw_low_x 0) (Times (1 # 524288) (Given
    greater_6 0))) (Sub (Add (Times (1 # 2) (Given high_x 0)) (Times (1 # 2) (Given low_x 0))) (Mul (Add (Times (1 #
    2) (Given high_z 0)) (Times (1 # 2) (Given low_z 0))) (Given shear_x 0))))))) (Mul (Add (Mul (Abs (Given shear_x
    0)) (Times (4236247 # 4194304) (Given greater_8 0))) (Times (4236247 # 4194304) (Given greater_9 0))) (Given
    quotient_2 0)).
Definition greater_12_other :=
  Add (Abs (Sub (Const (1 # 4)) (Mul (Given quotient_3 0) (Sub (Sub (Given raw_low_y 0) (Times (1 # 524288) (Given
    greater_6 0))) (Sub (Add (Times (1 # 2) (Given high_y 0)) (Times (1 # 2) (Given low_y 0))) (Mul (Add (Times (1 #
    2) (Given high_z 0)) (Times (1 # 2) (Given low_z 0))) (Given shear_y 0))))))) (Mul (Add (Mul (Abs (Given shear_y
    0)) (Times (4236247 # 4194304) (Given greater_8 0))) (Times (4236247 # 4194304) (Given greater_11 0))) (Given
    quotient_3 0)).
(* point_error = point_error_constant * (Given greater_12 0) *)
Definition point_error_constant : Q := 5295309 # 8796093022208.
Definition height_error :=
  Times (5295309 # 8796093022208) (Times (4236247 # 4194304) (Given greater_8 0)).
Definition greater_13_one :=
  Add (Const (1 # 262144)) (Diff raw_high_x raw_low_x).
Definition greater_13_other :=
  greater_10_other.
Definition quotient_4_over :=
  quotient_3_over.
Definition quotient_4_under := Given greater_13 0.
Definition greater_14_one :=
  Add (Const (1 # 262144)) (Diff raw_high_y raw_low_y).
Definition greater_14_other :=
  greater_13_other.
Definition quotient_5_over :=
  quotient_4_over.
Definition quotient_5_under := Given greater_14 0.
Definition greater_15_one :=
  Add (Abs (Sub (Const (1 # 4)) (Mul (Add (Const (-1 # 524288)) (Given raw_low_x 0)) (Given quotient_4 0)))) (Given
    quotient_4 0).
Definition greater_15_other :=
  Add (Abs (Sub (Const (1 # 4)) (Mul (Add (Const (-1 # 524288)) (Given raw_low_y 0)) (Given quotient_5 0)))) (Given
    quotient_5 0).
Definition ratio_error :=
  Times (4236247 # 4194304) (Add (Times (5 # 8388608) (Add (Given width 0) (Given greater_15 0))) (Times (1 #
    4194304) (Given width 0))).
Definition inverse_error :=
  Const (7 # 8388608).
Definition largest_extent :=
  Const (1000000015047466219876688855040 # 1).
Definition smallest :=
  Const (9444733 # 9444732965739290427392).
(* end: from the kernels *)

Open Scope R_scope.
Local Notation u := (/ 16777216).
Local Notation h := h32.
Local Notation computed := computes32.
(* Rows but for one entry, and the offset, are no denormals. *)
Definition may_lose i := if orb (Nat.eqb i row) (orb (Nat.eqb i row_1) (Nat.leb row_3 i)) then 0%Q else h32Q.
Definition rows_are_normal x := forall i, may_lose i = 0%Q -> x i = 0 \/ 2 * h <= Rabs (x i).
Lemma kept x : rows_are_normal x -> keeps x may_lose.
Proof.
  intros N i. specialize (N i). revert N. unfold may_lose. destruct (orb _ _); [right | now left]. split; [reflexivity |].
  now apply N.
Qed.
Ltac take_lost C K :=
  assert (off := computed_is_off u32 h32 (bpow_ge_0 _ _) (bpow_ge_0 _ _) rounds32 seen32 rounds32_near seen32_near _
    (fun i => Q2R (may_lose i)) (keeps_range _ _ K) (keeps_near _ _ K) _ _ C); clear C; rename off into C;
  cbn -[u32 h32 alpha Q2R h32Q] in C; unfold of_product, alpha in C;
  rewrite ?u32_value, ?h32_is, ?Q2R_0' in C; simpl pow in C.

(* ---- The reach ---- *)
Definition middle i j := Add (Times (1 # 2) (Given i 0)) (Times (1 # 2) (Given j 0)).
Definition side i a := Abs (Sub (Given i 0) a).  (* for the center's coordinate a, a float *)
Lemma sides_are :
  greater_8_one = side high_z (middle high_z low_z) /\ greater_8_other = side low_z (middle high_z low_z) /\
  greater_9_one = side high_x (middle high_x low_x) /\ greater_9_other = side low_x (middle high_x low_x).
Proof. repeat split. Qed.
Theorem reach_is_enough x low high c p a b : computed x (side high (Given c 0)) a -> computed x (side low (Given c 0)) b ->
  x low <= p <= x high -> Rabs (p - x c) <= (1 + 2 * u) * Rmax a b + 8 * h.
Proof.
  assert (S : forall i v, computed x (side i (Given c 0)) v -> Rabs (x i - x c) <= (1 + 2 * u) * v + 8 * h).
  { clear. intros i v C. inversion C as [ | | | | | ? q s N E | | | | ]; subst. apply seen32_near in E.
    destruct (step32_sub _ _ _ _ N) as (y & z & Cy & Cz & G). apply given32_is in Cy, Cz. subst.
    assert (T := Rabs_triang_inv (x i - x c) (x i - x c - q)). rewrite (Rabs_minus_sym (x i - x c) q) in T.
    replace (x i - x c - (x i - x c - q)) with q in T by ring. assert (Z := Rabs_pos (x i - x c)).
    assert (h0 := h32_positive). assert (T2 := Rabs_triang_inv q (q - s)). replace (q - (q - s)) with s in T2 by ring.
    rewrite Rabs_minus_sym in E. lra. }
  intros Ca Cb P. apply S in Ca. apply S in Cb. apply between in Ca, Cb.
  assert (A := Rmax_l a b). assert (B := Rmax_r a b). apply Rabs_le. lra.
Qed.

(* ---- A direction ---- *)
Section Direction.
Variable x : nat -> R.
Variable slope : R.
Let s := x quotient_2.
Let d_x := Rabs (x point_x - x center_x).
Let d_z := Rabs (x point_z - x center_z).
Hypotheses (s0 : 0 < s) (slope_near : Rabs (x shear_x - slope) <= 101 / 100 * u * Rabs slope + h).
Hypothesis (rows_normal : rows_are_normal x).
Hypotheses (row_is : x row = s) (row_1_is : x row_1 = 0) (row_2_near : Rabs (x row_2 + s * x shear_x) <= u * (s * Rabs (x
  shear_x)) + h * (1 + 2 * s)).
(* The reaches before the 1 % (greater_9 and greater_8). *)
Hypotheses (in_reach_x : d_x <= (1 + 2 * u) * x greater_9 + 8 * h).
Hypothesis (in_reach_z : d_z <= (1 + 2 * u) * x greater_8 + 8 * h).
Hypotheses (s_in : s <= 2 ^ 76) (s_z_in : s * x greater_8 <= 2 ^ 36) (z_in : 0 <= x greater_8 <= 101 * 10 ^ 28) (shear_in : Rabs (x
  shear_x) <= 1).
Hypotheses (x_in : 0 <= x greater_9 <= 101 * 10 ^ 28) (s_x_in : s * x greater_9 <= 2 ^ 36) (offset_in : / 5 <= Rabs (x row_3)).
Definition real_coordinate := s * (x point_x - x center_x) - s * slope * (x point_z - x center_z) + x row_3.
Definition size_of_row := Rabs (x row_3) + s * (x greater_9 + Rabs (x shear_x) * x greater_8).

Lemma direction_takes : 0 < h <= / 2 ^ 126 /\ 0 <= h * s <= / 2 ^ 50 /\ 0 <= h * d_z <= 2 / 10 * u /\
  0 <= h * (s * d_z) <= / 2 ^ 80 /\ 0 <= s * d_z /\ 0 <= s * h * h <= / 2 ^ 170 /\
  0 <= h * h <= h.
Proof.
  assert (h0 := h32_powers). assert (z0 : 0 <= d_z) by apply Rabs_pos. assert (sz : 0 <= s * d_z) by (apply Rmult_le_pos; lra).
  assert (sh : 0 <= s * h) by (apply Rmult_le_pos; lra).
  assert (hs : s * h <= 2 ^ 76 * / 2 ^ 126) by (apply Rmult_le_compat; lra).
  assert (hz : h * d_z <= / 2 ^ 126 * (1001 / 1000 * (101 * 10 ^ 28))) by (apply Rmult_le_compat; lra).
  assert (sz1 := Rmult_le_compat_l s _ _ ltac:(lra) in_reach_z).
  assert (hsz : h * (s * d_z) <= / 2 ^ 126 * 2 ^ 40) by (apply Rmult_le_compat; lra).
  assert (hz0 : 0 <= h * d_z) by (apply Rmult_le_pos; lra). assert (hsz0 : 0 <= h * (s * d_z)) by (apply Rmult_le_pos; lra).
  assert (shh : s * h * h <= 2 ^ 76 * / 2 ^ 126 * / 2 ^ 126) by (apply Rmult_le_compat; lra).
  assert (shh0 : 0 <= s * h * h) by (apply Rmult_le_pos; lra).
  repeat split; lra.
Qed.
Theorem coordinate_near v : computed x value v -> Rabs (v - real_coordinate) <= 86 / 10 * u * size_of_row.
Proof.
  intros C. take_lost C (kept x rows_normal).
  destruct direction_takes as (h0 & hs & hz & hsz & sz0 & shh & hh).
  rewrite row_is, row_1_is, Rabs_R0, !Rmult_0_l, !Rplus_0_l in C. fold d_x d_z in C. rewrite (Rabs_pos_eq s) in C by lra.
  set (g := Rabs (x shear_x)) in *. assert (g0 : 0 <= g) by apply Rabs_pos. assert (z0 : 0 <= d_z) by apply Rabs_pos.
  assert (x0 : 0 <= d_x) by apply Rabs_pos. assert (sg : 0 <= s * g) by (apply Rmult_le_pos; lra).
  assert (r2 : Rabs (x row_2) <= (1 + u) * (s * g) + h * (1 + 2 * s)).
  { assert (T := Rabs_triang (x row_2 + s * x shear_x) (- (s * x shear_x))).
  rewrite Rabs_Ropp, Rabs_mult, (Rabs_pos_eq s) in T by lra.
    replace (x row_2 + s * x shear_x + - (s * x shear_x)) with (x row_2) in T by ring. unfold g in *. lra. }
  assert (slope_size : Rabs slope <= (1 + 2 * u) * g + 2 * h).
  { assert (T := Rabs_triang_inv slope (slope - x shear_x)). replace (slope - (slope - x shear_x)) with (x shear_x) in T
    by ring.
    rewrite (Rabs_minus_sym slope) in T. assert (Z := Rabs_pos slope). unfold g. lra. }
  assert (G1 := Rmult_le_compat_l s _ _ ltac:(lra) in_reach_x).
  assert (G2 := Rmult_le_compat_r d_z _ _ z0 r2).
  assert (G2' := Rmult_le_compat_l (s * g) _ _ sg in_reach_z).
  (* What the row's entry is off by, times the point's. *)
  assert (entry : Rabs (x row_2 + s * slope) <= 203 / 100 * u * (s * g) + h * (1 + 4 * s)).
  { replace (x row_2 + s * slope) with ((x row_2 + s * x shear_x) + - (s * (x shear_x - slope))) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite Rabs_Ropp, (Rabs_mult s), (Rabs_pos_eq s) by lra.
    assert (G := Rmult_le_compat_l s _ _ ltac:(lra) slope_near).
    assert (H := Rmult_le_compat_l s _ _ ltac:(lra) slope_size). lra. }
  assert (G3 := Rmult_le_compat_r d_z _ _ z0 entry). unfold d_z in G3 at 1.
  rewrite <- Rabs_mult in G3.
  assert (o0 := Rabs_pos (x row_3)).
  assert (W : 0 <= s * x greater_9) by (apply Rmult_le_pos; lra).
  assert (W' : 0 <= s * g * x greater_8) by (apply Rmult_le_pos; lra).
  assert (gh : s * g * h <= s * 1 * h) by (apply Rmult_le_compat_r; [lra | apply Rmult_le_compat_l; lra]).
  assert (h2 := Rmult_le_compat_l h _ _ ltac:(lra) r2).
  assert (hx : 0 <= h * d_x <= / 2 ^ 126 * (1001 / 1000 * (101 * 10 ^ 28))).
  { split; [apply Rmult_le_pos | apply Rmult_le_compat]; lra. }
  unfold real_coordinate, size_of_row in *. fold g. apply between in C, G3. apply Rabs_le. lra.
Qed.

Hypotheses (row_of_heights_is : x row_of_heights = 0) (row_of_heights_1_is : x row_of_heights_1 = 0).
Hypotheses (row_of_heights_2_is : Rabs (x row_of_heights_2) = 1) (row_of_heights_3_is : x row_of_heights_3 = 0).
Theorem height_near v : computed x height v ->
  Rabs (v - x row_of_heights_2 * (x point_z - x center_z)) <= 41 / 10 * u * x greater_8 + 16 * h.
Proof.
  intros C. take_lost C (kept x rows_normal).
  rewrite row_of_heights_is, row_of_heights_1_is, row_of_heights_2_is, row_of_heights_3_is, Rabs_R0, !Rmult_0_l,
    !Rplus_0_l, Rplus_0_r, Rmult_1_l, Rplus_0_r in C. fold d_z in C.
  destruct direction_takes as (h0 & _). assert (z0 : 0 <= d_z) by apply Rabs_pos. lra.
Qed.
End Direction.

(* ---- A point light ---- *)
Section Position.
Variable x : nat -> R.
Let scale := x quotient_4.
Let W := x row_of_heights_2 * (x point_z - x center_z).
Let texels := x width.
Variables o unit : R.  (* the offset and the power of two that both rows are multiplied by *)
Hypotheses (scale0 : 0 <= scale) (unit0 : 0 < unit) (texels1 : 1 <= texels) (W0 : / 2 ^ 51 <= W).
Hypotheses (rows_normal : rows_are_normal x) (unit_in : / 2 ^ 100 <= unit <= 1).
Hypotheses (scale_in : scale <= 2 ^ 36) (o_in : Rabs o <= 2 ^ 36).  (* at most 2^16 texels over 64 u *)
Hypotheses (row_is : x row = scale * unit) (row_1_is : x row_1 = 0) (row_2_is : Rabs (x row_2) <= Rabs o * unit + 3 * h)
  (row_3_is : x row_3 = 0).
Hypotheses (row_of_heights_is : x row_of_heights = 0) (row_of_heights_1_is : x row_of_heights_1 = 0).
Hypotheses (row_of_heights_2_is : Rabs (x row_of_heights_2) = unit) (row_of_heights_3_is : x row_of_heights_3 = 0).
Hypotheses (in_face : Rabs (x point_x - x center_x) <= (1 + 2 * u) * Rabs (x point_z - x center_z)).

Lemma W_is : W = unit * Rabs (x point_z - x center_z).
Proof. rewrite <- row_of_heights_2_is, <- Rabs_mult, Rabs_pos_eq; [reflexivity | unfold W in W0; lra]. Qed.
Lemma position_takes : 0 < h <= / 2 ^ 126 /\ 0 <= h * h <= h /\ h <= / 2 ^ 70 * W /\
  0 <= h * Rabs (x point_z - x center_z) <= u * / 3 * W /\ 0 <= unit * h <= h.
Proof.
  assert (h0 := h32_powers). assert (z0 := Rabs_pos (x point_z - x center_z)).
  assert (u1 : unit * h <= 1 * h) by (apply Rmult_le_compat_r; lra). assert (u0 : 0 <= unit * h) by (apply Rmult_le_pos; lra).
  assert (hz0 : 0 <= h * Rabs (x point_z - x center_z)) by (apply Rmult_le_pos; lra).
  assert (G := Rmult_le_compat_r (Rabs (x point_z - x center_z)) _ _ z0 (proj1 unit_in)). rewrite <- W_is in G.
  assert (H := Rmult_le_compat_r (Rabs (x point_z - x center_z)) _ _ z0 (proj2 (proj1 h0))). repeat split; lra.
Qed.
Lemma W_near w : computed x height w -> Rabs (w - W) <= 402 / 100 * u * W.
Proof.
  intros C. take_lost C (kept x rows_normal).
  rewrite row_of_heights_is, row_of_heights_1_is, row_of_heights_2_is, row_of_heights_3_is, Rabs_R0, !Rmult_0_l, !Rplus_0_l,
    !Rplus_0_r in C. fold W in C. rewrite <- W_is in C. destruct position_takes as (h0 & hh & hW & hz & uh). lra.
Qed.
Definition real_x := x row * (x point_x - x center_x) + x row_2 * (x point_z - x center_z).
Lemma x_near v : computed x value v -> Rabs (v - real_x) <= 402 / 100 * u * ((scale + Rabs o) * W) + u * / 2 * W.
Proof.
  intros C. take_lost C (kept x rows_normal). destruct position_takes as (h0 & hh & hW & hz & uh).
  assert (r : Rabs (x row) = scale * unit) by (rewrite row_is; apply Rabs_pos_eq, Rmult_le_pos; lra).
  rewrite r, row_1_is, row_3_is, Rabs_R0, !Rmult_0_l, !Rplus_0_l, !Rplus_0_r in C. fold real_x in C.
  set (D := Rabs (x point_z - x center_z)) in *. assert (D0 : 0 <= D) by apply Rabs_pos.
  assert (su : 0 <= scale * unit) by (apply Rmult_le_pos; lra).
  assert (ou : 0 <= Rabs o * unit) by (apply Rmult_le_pos; auto using Rabs_pos; lra).
  assert (G := Rmult_le_compat_l _ _ _ su in_face). assert (G2 := Rmult_le_compat_r D _ _ D0 row_2_is).
  assert (suh : scale * (unit * h) <= 2 ^ 36 * h) by (apply Rmult_le_compat; lra).
  assert (ouh : Rabs o * (unit * h) <= 2 ^ 36 * h) by (apply Rmult_le_compat; try lra; apply Rabs_pos).
  assert (h2 := Rmult_le_compat_l h _ _ ltac:(lra) row_2_is).
  assert (Z : 0 <= scale * W) by (apply Rmult_le_pos; lra). assert (Z' : 0 <= Rabs o * W) by (apply Rmult_le_pos; try lra; apply
    Rabs_pos).
  assert (P1 : scale * unit * ((1 + 2 * u) * D) + Rabs o * unit * D <= (1 + 2 * u) * ((scale + Rabs o) * W)).
  { rewrite W_is. fold D. assert (Z2 : 0 <= Rabs o * unit * D) by (apply Rmult_le_pos; lra). lra. }
  lra.
Qed.

Definition of_texels := 96 / 10 * u.
Theorem ratio_near v w r : computed x value v -> computed x height w -> Rabs (r - v / w) <= 501 / 100 * u * Rabs (v / w) + 3 * h ->
  Rabs r <= texels -> Rabs (r - real_x / W) <= 41 / 10 * u * (scale + Rabs o) + of_texels * texels.
Proof.
  intros Cv Cw Hr Tr. destruct position_takes as (h0 & _). apply x_near in Cv. apply W_near in Cw. apply between in Cw. assert (w0 : 0 < w) by lra.
  set (q := v / w) in *.
  assert (q_in : Rabs q <= (1 + 6 * u) * texels).
  { assert (T := Rabs_triang_inv q (q - r)). replace (q - (q - r)) with r in T by ring. rewrite (Rabs_minus_sym q) in T.
    assert (Z := Rabs_pos q). lra. }
  replace (r - real_x / W) with ((r - q) + ((v - real_x) * / W + - (q * ((w - W) * / W)))) by (unfold q; field; lra).
  assert (W1 : 0 < W) by lra. assert (I := Rinv_0_lt_compat _ W1).
  assert (E1 : Rabs ((v - real_x) * / W) <= 402 / 100 * u * (scale + Rabs o) + u * / 2).
  { rewrite Rabs_mult, (Rabs_pos_eq (/ W)) by lra.
    replace (402 / 100 * u * (scale + Rabs o) + u * / 2) with ((402 / 100 * u * ((scale + Rabs o) * W) + u * / 2 * W) * / W)
      by (field; lra).
    apply Rmult_le_compat_r; lra. }
  assert (E2 : Rabs ((w - W) * / W) <= 402 / 100 * u).
  { rewrite Rabs_mult, (Rabs_pos_eq (/ W)) by lra. replace (402 / 100 * u) with (402 / 100 * u * W * / W) by (field; lra).
    apply Rmult_le_compat_r; [lra |]. apply Rabs_le; lra. }
  assert (E3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) q_in E2). rewrite <- Rabs_mult in E3.
  assert (E4 := Rmult_le_compat_l (501 / 100 * u) _ _ ltac:(lra) q_in). apply between in E1, E3.
  apply between in Hr. assert (o0 := Rabs_pos o). unfold of_texels.
  apply Rabs_le. lra.
Qed.

Theorem inverse_near w z : computed x height w -> Rabs (z - / w) <= 501 / 100 * u * Rabs (/ w) ->
  Rabs (z - / W) <= 91 / 10 * u * Rabs z.
Proof.
  intros Cw Hz. apply W_near in Cw. apply between in Cw. assert (w0 : 0 < w) by lra. assert (I := Rinv_0_lt_compat _ w0).
  rewrite (Rabs_pos_eq (/ w)) in Hz by lra. apply between in Hz. rewrite (Rabs_pos_eq z) by lra.
  assert (W1 : 0 < W) by lra. assert (J := Rinv_0_lt_compat _ W1).
  assert (E : / W * w <= 1 + 402 / 100 * u /\ 1 - 402 / 100 * u <= / W * w).
  { assert (K := Rinv_l W ltac:(lra)). assert (G := Rmult_le_compat_l (/ W) (w - W) (402 / 100 * u * W) ltac:(lra)
    ltac:(lra)).
    assert (H := Rmult_le_compat_l (/ W) (- (402 / 100 * u * W)) (w - W) ltac:(lra) ltac:(lra)).
    replace (/ W * (402 / 100 * u * W)) with (402 / 100 * u * (/ W * W)) in G by ring.
    replace (/ W * (- (402 / 100 * u * W))) with (- (402 / 100 * u) * (/ W * W)) in H by ring. rewrite K in G, H. lra. }
  assert (F : / W = / W * w * / w) by (field; lra).
  assert (G1 := Rmult_le_compat_r (/ w) _ _ ltac:(lra) (proj1 E)).
  assert (G2 := Rmult_le_compat_r (/ w) _ _ ltac:(lra) (proj2 E)).
  rewrite <- F in G1, G2. apply Rabs_le. lra.
Qed.
End Position.

(* ---- The kernel's bounds, less their own roundings ---- *)
Definition size_of_greater_12 o :=
  Add (Abs o) (Mul (Add (Mul (Abs (Given shear_x 0)) (Times (4236247 # 4194304) (Given greater_8 0)))
    (Times (4236247 # 4194304) (Given greater_9 0))) (Given quotient_2 0)).
Lemma bounds_are :
  (exists o, greater_12_one = size_of_greater_12 o) /\ (exists o, greater_15_one = Add (Abs o) (Given quotient_4 0)).
Proof. split; eexists; reflexivity. Qed.
Definition of_heights : Q := match height_error with Times c (Times d _) => c * d | _ => 0%Q end.
Definition of_ratios : Q * Q := match ratio_error with Times c (Add (Times d _) (Times e _)) => (c * d, c * (d + e))%Q |
  _ => (0%Q, 0%Q) end.
Definition of_inverse : Q := match inverse_error with Const c => c | _ => 0%Q end.
Definition value_of e : Q := match e with Const c => c | _ => 0%Q end.
(* A point's W is a difference that rounds once, its distance from the center that of two floats. *)
Lemma range_is_enough : Qle_bool (1 # 2 ^ 51) (value_of smallest * (1 - (8 # 2 ^ 24))) = true /\
  Qle_bool (value_of largest_extent * (1 + (8 # 2 ^ 24))) (101 * 10 ^ 28) = true.
Proof. vm_compute. auto. Qed.
Definition least_point : Q := 86 # 167772160.
Definition least_texels : Q := 96 # 167772160.
Lemma kernels_are_enough :
  let less := (1 - alphaQ u32Q 8)%Q in
  Qle_bool least_point (point_error_constant * less) = true /\ Qle_bool (41 # 167772160) (of_heights * less) = true /\
  Qle_bool (41 # 167772160) (fst of_ratios * less) = true /\ Qle_bool least_texels (snd of_ratios * less) = true /\
  Qle_bool (91 # 167772160) of_inverse = true.
Proof. vm_compute. auto 6. Qed.

Definition constants := Eval vm_compute in shown least_point point_error_constant.
Print constants.
Definition rests := Eval vm_compute in shown least_texels (Qred (snd of_ratios)).
Print rests.
Definition checked :=
  (reach_is_enough, coordinate_near, height_near, ratio_near, inverse_near, bounds_are, range_is_enough, kernels_are_enough).
Print Assumptions checked.
