(* SPDX-License-Identifier: MIT *)
(* The proofs of cut_out_means.v (double) and cut_out_means_float.v (float), which load this text. They have defined the
   kernel's expressions, `computed`, h and half_ulp, half an ulp of 1, and few, more than underflow takes of an operation; and
   shown for each operation that its result is off by at most h of itself and few (given_is to times_near). *)
Definition shared := 99%nat.  (* upper, or alpha_error *)
Definition along i j := Add (Given i 0) (Mul (Diff at_x first_x) (Diff j i)).
Definition upper := along texels_x texels_y.
Definition lower := along texels_z texels_w.
Definition mean_of a := Add a (Mul (Sub lower a) (Diff at_y first_y)).
Lemma mean_is : mean = mean_of upper.
Proof. reflexivity. Qed.

Lemma off_by v s b e : Rabs (v - s) <= h * Rabs s + e -> Rabs s <= b -> Rabs (v - s) <= h * b + e.
Proof. intros. assert (h * Rabs s <= h * b) by (apply Rmult_le_compat_l; lra). lra. Qed.

(* ---- The mean ---- *)
Section Mean.
Variable x : nat -> R.
Let texel i := 0 <= x i <= 255.
Hypotheses (t_x : texel texels_x) (t_y : texel texels_y) (t_z : texel texels_z) (t_w : texel texels_w).
Let f := x at_x - x first_x.
Let g := x at_y - x first_y.
Variables F G : R.  (* the real ones *)
Hypotheses (f_in : 0 <= f <= 1) (g_in : 0 <= g <= 1) (F_in : 0 <= F <= 1) (G_in : 0 <= G <= 1).
Hypotheses (f_near : Rabs (f - F) <= x error_x) (g_near : Rabs (g - G) <= x error_y).

Lemma convex a b t l m : l <= a <= m -> l <= b <= m -> 0 <= t <= 1 -> l <= a * (1 - t) + b * t <= m.
Proof.
  intros. assert (A := Rmult_le_compat_r (1 - t) l a ltac:(lra) ltac:(lra)).
  assert (B := Rmult_le_compat_r t l b ltac:(lra) ltac:(lra)).
  assert (C := Rmult_le_compat_r (1 - t) a m ltac:(lra) ltac:(lra)).
  assert (D := Rmult_le_compat_r t b m ltac:(lra) ltac:(lra)). lra.
Qed.
Lemma mean_in a b t : 0 <= a <= 255 -> 0 <= b <= 255 -> 0 <= t <= 1 -> 0 <= a + t * (b - a) <= 255.
Proof. intros A B T. assert (C := convex _ _ _ _ _ A B T). lra. Qed.
Lemma along_near i j v : texel i -> texel j -> computed x (along i j) v ->
  Rabs (v - (x i + f * (x j - x i))) <= 403 / 100 * h * 255.
Proof.
  intros Ti Tj C. unfold texel in *. destruct (add_near _ _ _ _ C) as (p & q & Cp & Cq & N1). apply given_is in Cp. subst p.
  destruct (mul_near _ _ _ _ Cq) as (d & e & Cd & Ce & N2). apply diff_near in Cd, Ce. fold f in Cd.
  apply (off_by _ _ 1 few) in Cd; [| rewrite Rabs_pos_eq; lra]. apply (off_by _ _ 255 few) in Ce; [| apply Rabs_le; lra].
  assert (Cd' := between _ _ Cd). assert (Ce' := between _ _ Ce).
  specialize (N2 ltac:(apply Rabs_le; lra) ltac:(apply Rabs_le; lra)).
  assert (P : Rabs (d * e - f * (x j - x i)) <= 202 / 100 * h * 255).
  { replace (d * e - f * (x j - x i)) with ((d - f) * (e - (x j - x i)) + ((d - f) * (x j - x i) + f * (e - (x j - x
    i)))) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. assert (T := Rabs_triang ((d - f) * (x j - x i)) (f * (e - (x j - x i)))).
    rewrite !Rabs_mult in *. assert (D : Rabs (x j - x i) <= 255) by (apply Rabs_le; lra).
    assert (f1 : Rabs f <= 1) by (apply Rabs_le; lra).
    assert (M1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Cd Ce).
    assert (M2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) Cd D).
    assert (M3 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) f1 Ce). lra. }
  assert (I := mean_in _ _ _ Ti Tj f_in). apply between in P.
  assert (S : Rabs (f * (x j - x i)) <= 255).
  { rewrite Rabs_mult. assert (D : Rabs (x j - x i) <= 255) by (apply Rabs_le; lra).
  assert (f1 : Rabs f <= 1) by (apply Rabs_le; lra).
    assert (M := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) f1 D). lra. }
  apply between in S. apply (off_by _ _ (255 * (1001 / 1000)) few) in N2; [| apply Rabs_le; lra]. apply between in N2.
  apply (off_by _ _ (255 * (1001 / 1000)) few) in N1; [| apply Rabs_le; lra]. apply between in N1. apply Rabs_le. lra.
Qed.

Definition real_mean s t := (x texels_x + s * (x texels_y - x texels_x)) * (1 - t) + (x texels_z + s * (x texels_w - x
  texels_z)) * t.
Lemma cell_near : Rabs (real_mean f g - real_mean F G) <= 255 * (x error_x + x error_y).
Proof.
  assert (A := mean_in _ _ _ t_x t_y f_in). assert (B := mean_in _ _ _ t_z t_w f_in).
  set (u1 := x texels_x + f * (x texels_y - x texels_x)) in *. set (l1 := x texels_z + f * (x texels_w - x texels_z)) in *.
  replace (real_mean f g - real_mean F G) with ((g - G) * (l1 - u1) +
    (f - F) * ((1 - G) * (x texels_y - x texels_x) + G * (x texels_w - x texels_z))) by (unfold real_mean, u1, l1; ring).
  unfold texel in *. assert (D : Rabs (l1 - u1) <= 255) by (apply Rabs_le; lra).
  assert (D' : Rabs ((1 - G) * (x texels_y - x texels_x) + G * (x texels_w - x texels_z)) <= 255) by (apply Rabs_le;
    assert (C := convex (x texels_y - x texels_x) (x texels_w - x texels_z) G (- 255) 255 ltac:(lra) ltac:(lra) G_in); lra).
  eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult.
  assert (M1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) g_near D).
  assert (M2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) f_near D'). lra.
Qed.

Theorem mean_near v : computed x upper (x shared) -> computed x (mean_of (Given shared 0)) v ->
  Rabs (v - real_mean f g) <= 807 / 100 * h * 255.
Proof.
  intros Cu C. assert (Nu := along_near _ _ _ t_x t_y Cu). fold upper in Cu.
  destruct (add_near _ _ _ _ C) as (p & q & Cp & Cq & N1). apply given_is in Cp. subst p.
  destruct (mul_near _ _ _ _ Cq) as (d & e & Cd & Ce & N2). apply diff_near in Ce. fold g in Ce.
  destruct (sub_near _ _ _ _ Cd) as (l & a & Cl & Ca & N3). apply given_is in Ca. subst a.
  assert (Nl := along_near _ _ _ t_z t_w Cl). apply (off_by _ _ 1 few) in Ce; [| rewrite Rabs_pos_eq; lra].
  assert (A := mean_in _ _ _ t_x t_y f_in). assert (B := mean_in _ _ _ t_z t_w f_in).
  set (u1 := x texels_x + f * (x texels_y - x texels_x)) in *. set (l1 := x texels_z + f * (x texels_w - x texels_z)) in *.
  set (U := x shared) in *. apply between in Nu, Nl.
  apply (off_by _ _ (255 * (1001 / 1000)) few) in N3; [| apply Rabs_le; lra].
  assert (N3' := between _ _ N3).
  assert (Ce' := between _ _ Ce). specialize (N2 ltac:(apply Rabs_le; lra) ltac:(apply Rabs_le; lra)).
  assert (P : Rabs (d * e - (l - U) * g) <= 202 / 100 * h * 255).
  { replace (d * e - (l - U) * g) with ((d - (l - U)) * e + (l - U) * (e - g)) by ring.
    eapply Rle_trans; [apply Rabs_triang |]. rewrite !Rabs_mult.
    assert (e1 : Rabs e <= 1001 / 1000) by (apply between in Ce; apply Rabs_le; lra).
    assert (D : Rabs (l - U) <= 255 * (1001 / 1000)) by (apply Rabs_le; lra).
    assert (M1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) N3 e1).
    assert (M2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) D Ce). lra. }
  assert (S := convex 0 (l - U) g (- (255 * (1001 / 1000))) (255 * (1001 / 1000)) ltac:(lra) ltac:(lra) g_in).
  assert (I := convex U l g (0 - 5 * h * 255) (255 + 5 * h * 255) ltac:(lra) ltac:(lra) g_in).
  apply between in P. apply (off_by _ _ (255 * (1002 / 1000)) few) in N2; [| apply Rabs_le; lra]. apply between in N2.
  apply (off_by _ _ (255 * (1002 / 1000)) few) in N1; [| apply Rabs_le; lra]. apply between in N1.
  assert (E := convex (U - u1) (l - l1) g (- (403 / 100 * h * 255)) (403 / 100 * h * 255) ltac:(lra) ltac:(lra) g_in).
  replace (real_mean f g) with (u1 * (1 - g) + l1 * g) by (unfold real_mean, u1, l1; ring).
  apply Rabs_le. lra.
Qed.

(* Times an alpha a, which is off by x off, rounded once more. *)
Definition least_term : Q := (91 # 10) * half_ulp.
Theorem product_near v a A p : computed x upper (x shared) -> computed x (mean_of (Given shared 0)) v ->
  0 <= A <= 1 -> Rabs (a - A) <= x off -> Rabs (p - v * a) <= h * Rabs (v * a) + few ->
  Rabs (p - real_mean F G * A) <= (255 + / 1000) * (x error_x + x error_y + Q2R least_term + x off).
Proof.
  intros Cu C A_in Ha Hp. assert (N := mean_near _ Cu C). assert (K := cell_near).
  replace (Q2R least_term) with (91 / 10 * h) by (unfold Q2R, least_term, half_ulp; simpl; lra).
  assert (m_in : 0 <= real_mean f g <= 255).
  { assert (P := mean_in _ _ _ t_x t_y f_in). assert (Q := mean_in _ _ _ t_z t_w f_in).
    assert (R := convex _ _ _ _ _ P Q g_in). unfold real_mean. lra. }
  set (m := real_mean f g) in *. set (M := real_mean F G) in *.
  assert (o0 := Rle_trans _ _ _ (Rabs_pos _) Ha). assert (N' := between _ _ N).
  assert (v_in : Rabs v <= 255 + 9 * h * 255) by (apply Rabs_le; lra).
  assert (near_M : Rabs (v - M) <= 255 * (x error_x + x error_y) + 807 / 100 * h * 255).
  { replace (v - M) with ((v - m) + (m - M)) by ring. eapply Rle_trans; [apply Rabs_triang |]. lra. }
  assert (P : Rabs (v * a - M * A) <= (255 * (x error_x + x error_y) + 807 / 100 * h * 255) * 1 + (255 + 9 * h * 255) * x
    off).
  { replace (v * a - M * A) with ((v - M) * A + v * (a - A)) by ring. eapply Rle_trans; [apply Rabs_triang |].
  rewrite !Rabs_mult.
    assert (A1 : Rabs A <= 1) by (rewrite Rabs_pos_eq; lra).
    assert (M1 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) near_M A1).
    assert (M2 := Rmult_le_compat _ _ _ _ (Rabs_pos _) (Rabs_pos _) v_in Ha). lra. }
  assert (S : Rabs (v * a) <= (255 + 9 * h * 255) * (1 + x off)).
  { rewrite Rabs_mult. apply Rmult_le_compat; auto using Rabs_pos. apply between in Ha. apply Rabs_le. lra. }
  apply (off_by _ _ _ few Hp) in S. assert (e0 := Rle_trans _ _ _ (Rabs_pos _) f_near).
  assert (e1 := Rle_trans _ _ _ (Rabs_pos _) g_near). apply between in P, S. apply Rabs_le. lra.
Qed.

(* ---- The alpha's bounds ---- *)
Let e := x shared.  (* here alpha_error *)
Definition low_of c := Times c (Sub (Given quotient_1 0) (Given shared 0)).
Definition high_of c := Times c (Add (Given shared 0) (Given quotient_1 0)).
Theorem alpha_is_between c d A l k : Rabs (x quotient_1 - A) <= e - / 4503599627370496 -> 0 <= A -> Q2R c <= 1 - 301 / 100 * h -> / 2 <= Q2R c ->
  1 + 301 / 100 * h <= Q2R d <= 2 -> / 2251799813685248 <= e ->
  computed x (low_of c) l -> computed x (high_of d) k -> 0 <= l -> (1 + h) * l <= A <= (1 - h) * k.
Proof.
  intros H A0 Hc c0 [Hd Hd2] e_least Cl Ck l0. apply between in H.
  destruct (times_near _ _ _ _ Cl) as (p & Cp & N1). destruct (times_near _ _ _ _ Ck) as (q & Cq & N2).
  specialize (N1 ltac:(rewrite Rabs_pos_eq; lra)). specialize (N2 ltac:(rewrite Rabs_pos_eq; lra)).
  destruct (sub_near _ _ _ _ Cp) as (a & b & Ca & Cb & N3). destruct (add_near _ _ _ _ Cq) as (a' & b' & Ca' & Cb' & N4).
  apply given_is in Ca, Cb, Ca', Cb'. subst a b a' b'. fold e in N3, N4. set (y := x quotient_1) in *.
  assert (y0 : 0 <= e + y) by lra. rewrite (Rabs_pos_eq (e + y)) in N4 by lra. apply between in N4.
  assert (q0 : 0 <= q) by lra. assert (dq := Rmult_le_compat_r q _ _ q0 Hd).
  rewrite (Rabs_pos_eq (Q2R d * q)) in N2 by lra. apply between in N2. split; [| lra].
  assert (N3' : - (/ 1152921504606846976) <= y - e \/ p <= - / 2305843009213693952).
  { destruct (Rle_dec (- (/ 1152921504606846976)) (y - e)) as [d0 | d0]; [now left | right].
    rewrite (Rabs_left1 (y - e)) in N3 by lra. apply between in N3. lra. }
  destruct (Rle_dec 0 p) as [p0 | p0].
  - assert (cp := Rmult_le_compat_r p _ _ p0 Hc). assert (c00 : 0 <= Q2R c) by lra. assert (cp0 := Rmult_le_pos _ _ c00 p0).
    rewrite (Rabs_pos_eq (Q2R c * p)) in N1 by lra. apply between in N1.
    destruct (Rle_dec 0 (y - e)) as [d0 | d0].
    + rewrite (Rabs_pos_eq (y - e)) in N3 by lra. apply between in N3. destruct N3'; lra.
    + rewrite (Rabs_left1 (y - e)) in N3 by lra. apply between in N3. destruct N3'; lra.
  - assert (cp := Rmult_le_compat_r (- p) _ _ ltac:(lra) c0).
    rewrite (Rabs_left1 (Q2R c * p)) in N1 by lra. apply between in N1. destruct N3'; lra.
Qed.
End Mean.

(* What the kernel has: 257 times the sum, and 4 h around an alpha. *)
Definition kernels_term : Q := match error with Times _ (Add (Add _ (Const c)) _) => c | _ => 0%Q end.
Definition kernels_factor : Q := match error with Times f _ => f | _ => 0%Q end.
Definition low_factor : Q := match low with Times c _ => c | _ => 0%Q end.
Definition high_factor : Q := match high with Times c _ => c | _ => 0%Q end.
Lemma low_is : low = Times low_factor (Sub (Given quotient_1 5) (Add (Const (1 # 1125899906842624)) alpha_error)) /\
  high = Times high_factor (Add (Add (Const (1 # 1125899906842624)) alpha_error) (Given quotient_1 5)).
Proof. split; reflexivity. Qed.
Definition least_around : Q := (301 # 100) * half_ulp.
Lemma kernels_are_enough : (
  least_term <= kernels_term /\ 255 + (1 # 1000) <= kernels_factor * (1 - alphaQ half_ulp 4) /\
  1 # 2 <= low_factor <= 1 - least_around /\ 1 + least_around <= high_factor <= 2)%Q.
Proof. vm_compute. repeat split; discriminate. Qed.
Definition constants := Eval vm_compute in shown least_term kernels_term.
Print constants.
Definition rests := Eval vm_compute in shown least_around (high_factor - 1).
Print rests.
Definition checked := (mean_near, product_near, alpha_is_between, kernels_are_enough).
Print Assumptions checked.
